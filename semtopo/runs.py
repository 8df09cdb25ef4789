"""Labelled runs along real beams: the second door into the pipeline (R13).

In comes what a real robot's sensor reports, for each beam the labels met and how far each reaches;
out goes a `Scan`. This room knows nothing of worlds: a real robot has none.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from semtopo.errors import InvalidScanError
from semtopo.fan import Fan
from semtopo.scan import Runs, Scan, beam_rule
from semtopo.types import Floats, Kind, Pose


@dataclass(frozen=True, slots=True)
class _Run:
    """A stretch of one beam in one label: from `near` to `far` in m."""

    label: str
    kind: Kind
    near: float
    far: float


@dataclass(frozen=True, slots=True, kw_only=True)
class LabelledRuns:
    """What a real robot's sensor reports: for each beam the labels met, from the robot outwards.

    Beam i looks along theta + `angle_min` + i * `angle_increment` (rad, counter-clockwise). Each
    beam is a sequence of (label, radius in m where it ends), radii ascending. A beam whose last
    radius is below `range_max` ended at an obstacle; an empty beam saw nothing. Labels without an
    entry in `kinds` are spaces.

    Raises
    ------
    InvalidScanError
        Radii do not ascend or exceed `range_max`; a number is not finite; a label is empty; the
        beams do not advance, or go round more than once.
    """

    angle_min: float
    angle_increment: float
    range_max: float
    beams: Sequence[Sequence[tuple[str, float]]]
    kinds: Mapping[str, Kind]

    def __post_init__(self) -> None:
        """Check the angles and every radius."""
        if not all(map(math.isfinite, (self.angle_min, self.angle_increment, self.range_max))):
            raise InvalidScanError("angle_min, angle_increment and range_max must be finite")
        if self.range_max <= 0:
            raise InvalidScanError("range_max must be above 0")
        if len(self.beams) > 1 and self.angle_increment == 0:
            raise InvalidScanError("angle_increment must not be 0")
        if (len(self.beams) - 1) * abs(self.angle_increment) > 2 * math.pi * (1 + 1e-6):
            raise InvalidScanError("the beams go round more than once")
        if any(not label for beam in self.beams for label, _ in beam):
            raise InvalidScanError("a run needs a label")
        for number, beam in enumerate(self.beams):
            _check_radii(number, [radius for _, radius in beam], self.range_max)

    @property
    def ring(self) -> bool:
        """Whether the last beam is a neighbour of the first.

        So it is with three beams or more, when the gap between them is no wider than between any
        two others; the half more allows for rounded increments.
        """
        step = abs(self.angle_increment)
        gap = 2 * math.pi - (len(self.beams) - 1) * step
        return len(self.beams) > 2 and step / 2 < gap < step * 3 / 2  # noqa: PLR2004 -- a triangle

    def directions(self, theta: float) -> Floats:
        """Return the unit vector of each beam, (beams, 2), for a robot that looks along theta."""
        bearing = theta + self.angle_min + self.angle_increment * np.arange(len(self.beams))
        return np.stack([np.cos(bearing), np.sin(bearing)], axis=-1)

    def runs(self, beam: int) -> list[_Run]:
        """Return the runs of one beam up to its end, neighbours that are alike joined.

        The end is a run of kind OBSTACLE: the first that was reported (R2), or one of no length
        where the beam stopped short of `range_max`.
        """
        runs: list[_Run] = []
        near = 0.0
        for label, far in self.beams[beam]:
            kind = self.kinds.get(label, Kind.SPACE)
            alike = runs and runs[-1].kind is kind
            if alike and (kind is not Kind.SPACE or runs[-1].label == label):
                runs[-1] = replace(runs[-1], far=far)
            else:
                runs.append(_Run(label, kind, near, far))
            if kind is Kind.OBSTACLE:
                return runs
            near = far
        if runs and near < self.range_max:
            runs.append(_Run("", Kind.OBSTACLE, near, near))
        return runs


def from_runs(pose: Pose, seen: LabelledRuns) -> Scan:
    """Turn the labelled runs of a real sensor into a scan: the points lie at the radii given."""
    numbers: dict[str, int] = {}
    rows = [
        (beam, run.kind, numbers.setdefault(run.label, len(numbers)), run.near, run.far)
        for beam in range(len(seen.beams))
        for run in seen.runs(beam)
    ]
    columns = list(zip(*rows, strict=True)) or [()] * 5
    runs = Runs(
        beam=np.array(columns[0], dtype=np.intp),
        kind=np.array(columns[1], dtype=np.uint8),
        label=np.array(columns[2], dtype=np.intp),
        first=np.array(columns[3], dtype=np.float64),
        last=np.array(columns[4], dtype=np.float64),
    )
    fan = Fan(seen.directions(pose.theta), seen.ring)
    return Scan(pose.position, fan, tuple(numbers), beam_rule(runs))


def _check_radii(beam: int, radii: Sequence[float], range_max: float) -> None:
    """Refuse radii that do not ascend from above 0 to at most `range_max`."""
    last = 0.0
    for radius in radii:
        if not radius > last:  # also refuses NaN
            raise InvalidScanError(f"beam {beam}: radii must ascend from above 0")
        last = radius
    if last > range_max:
        raise InvalidScanError(f"beam {beam}: a radius exceeds range_max")
