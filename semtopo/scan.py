"""The characteristic points of a scan, U_r and O_xy (Alg. 2, l. 8-34).

In comes the measurement of a simulated sensor; out goes a `Scan`: on each beam, the intervals that
belong to a label (R6). Real robots' scans enter by `runs`. This room knows nothing of polygons.

Rules of this file: the beam rule is `beam_rule` alone, a pure function of kinds and labels; what
is kept is never a passage sample, and nothing after a beam's first obstacle.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from semtopo.fan import Fan
from semtopo.sensor import Measurement, Trace
from semtopo.types import NOWHERE, Bytes, Flags, Floats, Integers, Kind, Occupancy, Point


@dataclass(frozen=True, slots=True, eq=False)
class Intervals:
    """Pieces of beams that lie in one labelled space each, sorted by beam and then outwards (R6).

    All arrays have the shape (intervals,). `near` and `far` are distances from the robot in m;
    `near` is 0 where the interval starts at the robot. `source` is the label index of the space
    from which the beam came through one passage, or directly (R5), else `NOWHERE`; that space is
    the interval before, and may have the same label.
    """

    beam: Integers
    label: Integers
    near: Floats
    far: Floats
    near_occupancy: Bytes
    far_occupancy: Bytes
    source: Integers

    def __len__(self) -> int:
        """Return the number of intervals."""
        return len(self.beam)


@dataclass(frozen=True, slots=True, eq=False)
class Scan:
    """What one scan says about the spaces around the robot (U_r).

    `fan` holds the beams, in order of bearing. `labels` are what the label indices stand for. In an
    `exact` scan, intervals end where surfaces do (R16); else a surface may be farther by a
    `quantum` in m, the distance between samples.
    """

    position: Point
    fan: Fan
    labels: tuple[str, ...]
    intervals: Intervals
    exact: bool = False
    quantum: float = 0.0

    def points(self, intervals: Integers | Flags | slice, radii: Floats) -> Floats:
        """Return the points (n, 2) at distances on the beams of the chosen intervals, in m."""
        directions = self.fan.directions[self.intervals.beam[intervals]]
        return np.asarray(self.position) + radii[:, None] * directions

    def near_points(self, intervals: Integers | Flags | slice = slice(None)) -> Floats:
        """Return where the chosen intervals start, (n, 2) in m, map frame."""
        return self.points(intervals, self.intervals.near[intervals])

    def far_points(self, intervals: Integers | Flags | slice = slice(None)) -> Floats:
        """Return where the chosen intervals end, (n, 2) in m, map frame."""
        return self.points(intervals, self.intervals.far[intervals])

    def ends(self) -> tuple[Floats, Bytes]:
        """Return where each beam ends, (beams, 2) in m, map frame, and why, (beams,).

        That is the last point of its last interval. A beam without any ends at the robot, for no
        reason: NONE.
        """
        beams = np.arange(len(self.fan))
        last = np.searchsorted(self.intervals.beam, beams, side="right") - 1
        (seen,) = np.nonzero(np.isin(beams, self.intervals.beam))
        ends = np.tile(np.asarray(self.position, dtype=np.float64), (len(beams), 1))
        ends[seen] = self.far_points(last[seen])
        occupancy = np.zeros(len(beams), dtype=np.uint8)
        occupancy[seen] = self.intervals.far_occupancy[last[seen]]
        return ends, occupancy


class Runs(NamedTuple):
    """Stretches of beams on one surface each, sorted by beam and then outwards; (runs,) each.

    `first` and `last` are the distances in m of where the stretch was met first and last. `label`
    is that of a space. Two neighbours on a beam differ: in kind, or as spaces in label.
    """

    beam: Integers
    kind: Bytes
    label: Integers
    first: Floats
    last: Floats


def beam_rule(runs: Runs) -> Intervals:
    """Return the intervals of beams, and why they begin and end (Alg. 2, l. 8-32; R6).

    The rules stand in the paper's order: nothing from the first obstacle on (R2), and a passage
    before it counts for nothing (R3); both sides of a passage; both sides of a change of label (R5)
    or towards unknown (R13); the last sample.
    """
    starts = np.ones(len(runs.beam) + 1, dtype=np.bool_)  # where a beam begins, or the last ended
    np.not_equal(runs.beam[1:], runs.beam[:-1], out=starts[1:-1])
    chosen = ((runs.kind == SPACE) & ~_blocked(runs.kind, starts[:-1])).nonzero()[0]
    near, near_occupancy, source = _beginnings(runs, starts, chosen)
    far, after = runs.last[chosen], chosen + 1
    far_occupancy = _TOWARDS[runs.kind.take(after, mode="clip")]
    ends = starts[after]
    far_occupancy[ends] = FREE  # Alg. 2, l. 25-29
    far_occupancy[ends & (near == far)] = NONE  # l. 25 comes after l. 16, and R5
    return Intervals(
        runs.beam[chosen], runs.label[chosen], near, far, near_occupancy, far_occupancy, source
    )


SPACE, PASSAGE, OBSTACLE = map(int, (Kind.SPACE, Kind.PASSAGE, Kind.OBSTACLE))
NONE, FREE = int(Occupancy.NONE), int(Occupancy.FREE)
"""As plain numbers: numpy takes members of an enumeration apart at every comparison."""

_TOWARDS = np.empty(len(Kind), dtype=np.uint8)
"""The occupancy of a point where a space ends, by the kind of what lies beyond."""
_TOWARDS[Kind.SPACE] = Occupancy.PASSAGE  # R5
_TOWARDS[Kind.PASSAGE] = Occupancy.PASSAGE  # Alg. 2, l. 17-23
_TOWARDS[Kind.OBSTACLE] = Occupancy.OBSTACLE  # Alg. 2, l. 11-15
_TOWARDS[Kind.UNKNOWN] = Occupancy.FREE  # R13


def _blocked(kind: Bytes, starts: Flags) -> Flags:
    """Say of each run whether it is, or lies behind, the first obstacle of its beam (R2)."""
    obstacle = kind == OBSTACLE
    met = obstacle.cumsum()
    before = (met - obstacle) * starts  # where a beam starts, those of beams before; elsewhere 0
    blocked: Flags = met > np.maximum.accumulate(before)
    return blocked


def _beginnings(runs: Runs, starts: Flags, chosen: Integers) -> tuple[Floats, Bytes, Integers]:
    """Return where chosen runs begin, why there, and from which space the beam came (R15).

    That is the one before the one passage before the run, or where two touch (R5) the run before;
    its label is meant.
    """
    near, why = np.zeros(len(chosen)), np.zeros(len(chosen), dtype=np.uint8)
    label = np.full(len(chosen), NOWHERE)
    entered = (~starts[chosen]).nonzero()[0]
    if len(entered):  # the others begin at the robot
        run = chosen[entered]
        before = run - 1
        near[entered], why[entered] = runs.first[run], _TOWARDS[runs.kind[before]]
        source = before - ((runs.kind[before] == PASSAGE) & ~starts[before])
        label[entered] = np.where(runs.kind[source] == SPACE, runs.label[source], NOWHERE)
    return near, why, label


def analyse(measurement: Measurement | Trace) -> Scan:
    """Reduce a measurement to its characteristic points (Alg. 2, l. 8-34)."""
    sensor, surfaces = measurement.sensor, measurement.surfaces
    if isinstance(measurement, Trace):
        runs, exact = _traced_runs(measurement), True
    else:
        runs, exact = _sampled_runs(measurement), False
    return Scan(
        measurement.position, sensor.fan, surfaces.labels, beam_rule(runs), exact=exact,
        quantum=0.0 if exact else sensor.range / sensor.samples,
    )  # fmt: skip


def _traced_runs(seen: Trace) -> Runs:
    """Return the runs of exact beams: pieces that are alike joined."""
    kind, label = seen.surfaces.kind[seen.surface], seen.surfaces.label[seen.surface]
    differs = np.ones(len(kind) + 1, dtype=np.bool_)
    differs[1:-1] = (seen.beam[1:] != seen.beam[:-1]) | (kind[1:] != kind[:-1])
    differs[1:-1] |= (kind[1:] == Kind.SPACE) & (label[1:] != label[:-1])
    first, last = np.flatnonzero(differs[:-1]), np.flatnonzero(differs[1:])
    return Runs(seen.beam[first], kind[first], label[first], seen.near[first], seen.far[last])


def _sampled_runs(measurement: Measurement) -> Runs:
    """Return the runs of samples: from the first sample of each to its last."""
    sensor, surfaces = measurement.sensor, measurement.surfaces
    surface = measurement.surface.ravel()
    changed = np.ones(len(surface), dtype=np.bool_)
    np.not_equal(surface[1:], surface[:-1], out=changed[1:])
    changed[:: sensor.samples] = True
    first = changed.nonzero()[0]
    kind = surfaces.kind[surface[first]]
    differs = kind == SPACE
    differs[1:] |= kind[1:] != kind[:-1]
    differs |= sensor.radius[first] == sensor.radii[0]
    first, kind = first[differs], kind[differs]
    last = np.empty_like(first)
    last[:-1], last[-1:] = first[1:] - 1, len(surface) - 1
    label = surfaces.label[surface[first]]
    return Runs(sensor.beam[first], kind, label, sensor.radius[first], sensor.radius[last])
