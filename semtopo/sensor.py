"""The sensor U_s and its measurement U_xy (Alg. 2, l. 2-7).

In come a world and a position; out goes what each sample of each beam meets. This room does not
judge what it meets: that is `scan`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from semtopo.errors import InvalidPoseError, InvalidSensorError
from semtopo.types import Bytes, Floats, Integers, Point
from semtopo.world import World


@dataclass(frozen=True)
class Sensor:
    """A ring of evenly spaced beams U_s = (u_sD, u_sR, u_sQ), each sampled at equal distances.

    `range` is in m. `directions` (beams, 2) are unit vectors, beam 0 along +y and the others
    clockwise from it (R1); `radii` (samples,) are the distances of the samples in m.

    Raises
    ------
    InvalidSensorError
        Fewer than 1 beam or 2 samples (R4), or a range that is not a positive finite number.
    """

    beams: int = 72
    range: float = 2.0
    samples: int = 20
    directions: Floats = field(init=False, repr=False, compare=False)
    radii: Floats = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        """Refuse what cannot measure, and lay the beams out once."""
        if self.beams < 1:
            raise InvalidSensorError("a sensor needs at least 1 beam")
        if self.samples < 2:  # noqa: PLR2004 -- R4: the rule looks at pairs of samples
            raise InvalidSensorError("a sensor needs at least 2 samples on each beam")
        if not (math.isfinite(self.range) and self.range > 0):
            raise InvalidSensorError("a sensor needs a range that is a positive number of m")
        bearing = 2 * np.pi * np.arange(self.beams) / self.beams  # R1
        directions = np.stack([np.sin(bearing), np.cos(bearing)], axis=-1)
        radii = np.arange(1, self.samples + 1) * self.range / self.samples
        object.__setattr__(self, "directions", directions)
        object.__setattr__(self, "radii", radii)


@dataclass(frozen=True, slots=True, eq=False)
class Measurement:
    """What each sample met (U_xy): `label` (index into `labels`) and `kind`, (beams, samples)."""

    sensor: Sensor
    position: Point
    labels: tuple[str, ...]
    label: Integers
    kind: Bytes
    xy: Floats
    """Where the samples are, (beams, samples, 2), in m, map frame."""


def measure(world: World, sensor: Sensor, position: Point) -> Measurement:
    """Read the world at every sample of every beam (Alg. 2, l. 2-7).

    The position is in m, map frame; the robot's own place is not sampled (R4).

    Raises
    ------
    InvalidPoseError
        The position is not finite.
    """
    if not all(map(math.isfinite, position)):
        raise InvalidPoseError("a position needs finite x and y")
    reach = sensor.radii[None, :, None] * sensor.directions[:, None, :]
    xy = np.asarray(position) + reach  # Alg. 2, l. 5
    label, kind = world.read(xy)
    return Measurement(sensor, position, world.labels, label, kind, xy)
