"""The sensor U_s and its measurement U_xy (Alg. 2, l. 2-7), at samples or exactly.

In come a world and a position; out goes what each sample of each beam meets. This room does not
judge what it meets: that is `scan`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from semtopo.errors import InvalidPoseError, InvalidSensorError
from semtopo.fan import Fan
from semtopo.types import Bytes, Floats, Integers, Point
from semtopo.window import Offsets
from semtopo.world import Surfaces, World

CROSSINGS_MAX = 2**21
"""Beams times lines: cut in half a second."""

NO_LENGTH = 1e-12
"""m; so short is a piece of a beam through a corner, up to rounding."""


@dataclass(frozen=True)
class Sensor:
    """A ring of evenly spaced beams U_s = (u_sD, u_sR, u_sQ), each sampled at equal distances.

    `range` is in m. The `fan` holds the beams, beam 0 along +y and the others clockwise from it
    (R1); `radii` (samples,) are the distances of the samples in m. Of all samples, beam by beam,
    `beam` and `radius` (beams * samples,) say where they lie, as do the `offsets` from the robot.

    Raises
    ------
    InvalidSensorError
        Fewer than 1 beam or 2 samples (R4), or a range that is not a positive finite number.
    """

    beams: int = 72
    range: float = 2.0
    samples: int = 20
    fan: Fan = field(init=False, repr=False, compare=False)
    radii: Floats = field(init=False, repr=False, compare=False)
    beam: Integers = field(init=False, repr=False, compare=False)
    radius: Floats = field(init=False, repr=False, compare=False)
    offsets: Offsets = field(init=False, repr=False, compare=False)

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
        object.__setattr__(self, "fan", Fan(directions, ring=True))
        x, y = (radii * directions[:, None, axis] for axis in (0, 1))
        object.__setattr__(self, "radii", radii)
        object.__setattr__(self, "beam", np.arange(self.beams).repeat(self.samples))
        object.__setattr__(self, "radius", np.tile(radii, self.beams))
        object.__setattr__(self, "offsets", Offsets.of(x.ravel(), y.ravel(), self.range))


@dataclass(frozen=True, slots=True, eq=False)
class Measurement:
    """What each sample met (U_xy): `surface` (beams, samples), an index into the `surfaces`."""

    sensor: Sensor
    position: Point
    surfaces: Surfaces
    surface: Integers

    @property
    def labels(self) -> tuple[str, ...]:
        """What the label indices stand for."""
        return self.surfaces.labels

    @property
    def label(self) -> Integers:
        """The label index of each sample, (beams, samples)."""
        return self.surfaces.label[self.surface]

    @property
    def kind(self) -> Bytes:
        """The kind of each sample, (beams, samples)."""
        return self.surfaces.kind[self.surface]

    @property
    def xy(self) -> Floats:
        """Where the samples are, (beams, samples, 2), in m, map frame."""
        offsets = np.stack([self.sensor.offsets.x, self.sensor.offsets.y], axis=-1)
        return np.asarray(self.position) + offsets.reshape(*self.surface.shape, 2)


@dataclass(frozen=True, slots=True, eq=False)
class Trace:
    """What beams met, exactly: stretches of them, sorted by beam and then outwards; (runs,) each.

    `near` and `far` are distances from the robot in m, `surface` an index into the `surfaces`.
    """

    sensor: Sensor
    position: Point
    surfaces: Surfaces
    beam: Integers
    surface: Integers
    near: Floats
    far: Floats


def trace(world: World, sensor: Sensor, position: Point) -> Trace:
    """Find where every beam crosses from one surface to another (R16).

    The position is in m, map frame. Beams are cut at the lines on which edges of the world lie;
    each piece is of one surface, which is read in its middle.

    Raises
    ------
    InvalidPoseError
        The position is not finite.
    InvalidSensorError
        More edges are in reach of more beams than a step should take.
    """
    _check(position)
    lines = world.edges_around(position, sensor.range)
    if (len(lines[0]) + len(lines[1])) * sensor.beams > CROSSINGS_MAX:
        raise InvalidSensorError("too many edges of the world are in reach of exact beams")
    ends = _cuts(sensor, position, lines)
    near, far = ends[:, :-1], ends[:, 1:]
    beam, piece = np.nonzero(far - near > NO_LENGTH)
    near, far = near[beam, piece], far[beam, piece]
    middle = (near + far) / 2
    east, north = sensor.fan.directions[beam].T
    surface = world.read_around(position, Offsets.of(middle * east, middle * north, sensor.range))
    return Trace(sensor, position, world.surfaces, beam, surface, near, far)


def _cuts(sensor: Sensor, position: Point, lines: tuple[Floats, Floats]) -> Floats:
    """Return the distances at which each beam is cut by lines x = and y =, (beams, cuts).

    They ascend from 0 to the range, which stands for all cuts out of reach, too.
    """
    cuts = np.empty((sensor.beams, len(lines[0]) + len(lines[1]) + 2))
    cuts[:, 0], cuts[:, 1] = 0.0, sensor.range
    split = 2 + len(lines[0])
    with np.errstate(divide="ignore", invalid="ignore"):
        np.divide(lines[0] - position[0], sensor.fan.directions[:, :1], out=cuts[:, 2:split])
        np.divide(lines[1] - position[1], sensor.fan.directions[:, 1:], out=cuts[:, split:])
    cuts[~((cuts >= 0) & (cuts <= sensor.range))] = sensor.range
    cuts.sort(axis=1)
    return cuts


def measure(world: World, sensor: Sensor, position: Point) -> Measurement:
    """Read the world at every sample of every beam (Alg. 2, l. 2-7).

    The position is in m, map frame; the robot's own place is not sampled (R4).

    Raises
    ------
    InvalidPoseError
        The position is not finite.
    """
    _check(position)
    surface = world.read_around(position, sensor.offsets)  # Alg. 2, l. 5-6
    return Measurement(
        sensor, position, world.surfaces, surface.reshape(sensor.beams, sensor.samples)
    )


def _check(position: Point) -> None:
    """Refuse a position that is not finite."""
    if not all(map(math.isfinite, position)):
        raise InvalidPoseError("a position needs finite x and y")
