"""The characteristic points of a scan, U_r and O_xy (Alg. 2, l. 8-34).

In comes the measurement of a simulated sensor; out goes a `Scan`: on each beam, the intervals that
belong to a label (R6). Real robots' scans enter by `runs`. This room knows nothing of polygons.

Rules of this file: the beam rule is `beam_rule` alone, a pure function of kinds and labels; what
is kept is never a passage sample, and nothing after a beam's first obstacle.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from semtopo.sensor import Measurement
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

    `directions` (beams, 2) are unit vectors, in order of bearing; `ring` says whether the last
    beam is a neighbour of the first. `labels` are what the label indices stand for.
    """

    position: Point
    directions: Floats
    ring: bool
    labels: tuple[str, ...]
    intervals: Intervals

    def points(self, intervals: Integers | Flags | slice, radii: Floats) -> Floats:
        """Return the points (n, 2) at distances on the beams of the chosen intervals, in m."""
        directions = self.directions[self.intervals.beam[intervals]]
        return np.asarray(self.position) + radii[:, None] * directions

    def near_points(self, intervals: Integers | Flags | slice = slice(None)) -> Floats:
        """Return where the chosen intervals start, (n, 2) in m, map frame."""
        return self.points(intervals, self.intervals.near[intervals])

    def far_points(self, intervals: Integers | Flags | slice = slice(None)) -> Floats:
        """Return where the chosen intervals end, (n, 2) in m, map frame."""
        return self.points(intervals, self.intervals.far[intervals])


@dataclass(frozen=True, slots=True, eq=False)
class Kept:
    """What the beam rule keeps, per sample, (..., samples).

    `opens` and `closes` are occupancies: that of a sample which begins or ends an interval of its
    label, NONE elsewhere. `source` is, where an interval opens, the label of the space before the
    one passage through which the beam came, `NOWHERE` if there is none.
    """

    opens: Bytes
    closes: Bytes
    source: Integers


def beam_rule(kind: Bytes, label: Integers) -> Kept:
    """Return which samples of beams are kept, and why (Alg. 2, l. 8-32).

    Both arrays have the shape (..., samples), samples outwards. The rules stand in the paper's
    order: the sample before an obstacle, if it is a space (R3), and nothing from there on (R2);
    both sides of a passage; both sides of a change of label (R5) or towards unknown (R13); the
    last sample.
    """
    space = (kind == Kind.SPACE) & ~np.logical_or.accumulate(kind == Kind.OBSTACLE, axis=-1)
    before, after = kind[..., :-1], kind[..., 1:]
    relabelled = (
        (before == Kind.SPACE) & (after == Kind.SPACE) & (label[..., :-1] != label[..., 1:])
    )

    closes = np.zeros(kind.shape, dtype=np.uint8)
    closes[..., :-1][after == Kind.OBSTACLE] = Occupancy.OBSTACLE  # Alg. 2, l. 11-15
    closes[..., :-1][after == Kind.PASSAGE] = Occupancy.PASSAGE  # Alg. 2, l. 17-19
    closes[..., :-1][after == Kind.UNKNOWN] = Occupancy.FREE  # R13
    closes[..., :-1][relabelled] = Occupancy.PASSAGE  # R5
    closes[..., -1] = Occupancy.FREE  # Alg. 2, l. 25-29
    closes[~space] = Occupancy.NONE

    opens = np.zeros(kind.shape, dtype=np.uint8)
    opens[..., 1:][before == Kind.PASSAGE] = Occupancy.PASSAGE  # Alg. 2, l. 20-23
    opens[..., 1:][before == Kind.UNKNOWN] = Occupancy.FREE  # R13
    opens[..., 1:][relabelled] = Occupancy.PASSAGE  # R5
    opens[~space] = Occupancy.NONE
    closes[..., -1][opens[..., -1] > 0] = Occupancy.NONE  # l. 25 comes after l. 16, and R5
    return Kept(opens, closes, _sources(kind, label, opens))


def _sources(kind: Bytes, label: Integers, opens: Bytes) -> Integers:
    """Return, where an interval opens, the label before the one passage (R15), else `NOWHERE`."""
    samples = np.broadcast_to(np.arange(kind.shape[-1]), kind.shape)
    last = np.maximum.accumulate(np.where(kind == Kind.PASSAGE, -1, samples), axis=-1)
    # the last sample up to the one before that is no passage; -1 if there is none
    previous = np.concatenate([np.full((*kind.shape[:-1], 1), -1), last[..., :-1]], axis=-1)
    found = np.take_along_axis(kind, np.maximum(previous, 0), axis=-1) == Kind.SPACE
    source = np.take_along_axis(label, np.maximum(previous, 0), axis=-1)
    linked = (opens > 0) & (previous >= 0) & found
    return np.where(linked, source, NOWHERE)


def analyse(measurement: Measurement) -> Scan:
    """Reduce a measurement to its characteristic points (Alg. 2, l. 8-34)."""
    kind, label, sensor = measurement.kind, measurement.label, measurement.sensor
    kept = beam_rule(kind, label)
    begins, ends = kept.opens > 0, kept.closes > 0
    begins[:, 0] = kind[:, 0] == Kind.SPACE  # R6: the first interval starts at the robot
    ends[:, -1] |= begins[:, -1]  # R6: "or at its own start, if none follows"
    # intervals alternate begin, end along each beam, so the two lists match one to one
    beam, first = np.nonzero(begins)
    _, last = np.nonzero(ends)
    intervals = Intervals(
        beam=beam,
        label=label[beam, first],
        near=np.where(first == 0, 0.0, sensor.radii[first]),
        far=sensor.radii[last],
        near_occupancy=kept.opens[beam, first],
        far_occupancy=kept.closes[beam, last],
        source=kept.source[beam, first],
    )
    return Scan(
        measurement.position, sensor.directions, ring=True, labels=measurement.labels,
        intervals=intervals,
    )  # fmt: skip
