"""How a border runs around a robot: between which beams of a sector each of its sides lies.

In come the border of a region and a sector of a scan; out goes the course of the sides near the
sector, cut at the beams. Between two beams, a sector has but one far end and one near end; so what
a side can cross is known from its course.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from semtopo.border import Border
from semtopo.geometry import as_complex
from semtopo.sector import Sector
from semtopo.types import Complexes, Flags, Floats, Integers

UNCLEAR = 1e-11
"""m; ten times what rounding does to a place within a kilometre of the origin."""

TURN = 2 * math.pi


class UnclearError(Exception):
    """A border and a sector come too near to each other to tell which is farther out."""


@dataclass(frozen=True, slots=True, eq=False)
class Course:
    """The sides of a border near a sector: from each of some vertices to the next, if `real`.

    Of the vertices, `numbers` (n,) are the places in the border, `z` where they are, in m from the
    robot, and `wedges` after which beam of the sector. Sides are cut at the beams into legs, in
    order; a leg is of a `side` and in a wedge, `leg_wedges`. `begins` and `ends` are the first and
    the last legs of each side.

    The legs `cuts` begin at a `beam`: of their sides, `passes` says how far the line of each passes
    by the robot, in m, and `slant` the sine of its angle with the beam, both with the same sign.
    """

    numbers: Integers
    z: Complexes
    real: Flags
    wedges: Integers
    side: Integers
    leg_wedges: Integers
    begins: Integers
    ends: Integers
    cuts: Integers
    beam: Integers
    passes: Floats
    slant: Floats


def course_of(border: Border, sector: Sector) -> Course | None:
    """Return the course of the sides of a border near a sector; `None` if there are none.

    Raises
    ------
    UnclearError
        A side comes too near to the robot, or a vertex to the first or last beam.
    """
    numbers, real = _near(border, sector)
    if len(numbers) == 0:
        return None
    z = as_complex(border.xy)[numbers] - sector.position
    bearings = np.angle(z * sector.along[0].conj())
    bearings[bearings < 0] += TURN
    if not sector.closed:
        _check_edges(z, sector)
    wedges = sector.bearings.searchsorted(bearings, side="right") - 1
    turns = bearings[1:] - bearings[:-1]
    back, on = turns > math.pi, turns < -math.pi  # the short way leads over the first beam
    if (np.abs(np.abs(turns) - math.pi)[real] < NEAR_HALF_TURN).any():
        raise UnclearError
    steps = wedges[1:] - wedges[:-1]
    steps[back] -= len(sector.beams)
    steps[on] += len(sector.beams)
    steps *= real
    return _cut(numbers, z, real, wedges, steps, sector)


NEAR_HALF_TURN = 1e-6
"""rad; a side that takes so nearly half a turn around the robot passes by at no distance."""


def _near(border: Border, sector: Sector) -> tuple[Integers, Flags]:
    """Return the vertices of sides near a sector, and at which of them such a side begins."""
    low_x, low_y, high_x, high_y = sector.box
    x, y = border.xy[:, 0], border.xy[:, 1]
    apart = np.zeros(len(x), dtype=np.bool_)
    for beyond in (x < low_x, x > high_x, y < low_y, y > high_y):
        apart[:-1] |= beyond[1:] & beyond[:-1]
    apart[border.begins[1:] - 1] = True  # no side leads from one ring to the next
    near = ~apart
    chosen = near.copy()
    chosen[1:] |= near[:-1]
    numbers = chosen.nonzero()[0]
    return numbers, near[numbers[:-1]]


def _check_edges(z: Complexes, sector: Sector) -> None:
    """Refuse vertices on the first or the last beam of a sector, and at the robot."""
    for along in (sector.along[0], sector.along[-1]):
        turned = z * along.conj()
        if ((np.abs(turned.imag) < UNCLEAR) & (turned.real > -UNCLEAR)).any():
            raise UnclearError


def _cut(
    numbers: Integers, z: Complexes, real: Flags, wedges: Integers, steps: Integers, sector: Sector
) -> Course:
    """Cut sides at the beams: each goes so many `steps` from wedge to wedge, down if negative."""
    count = np.abs(steps) + 1
    ends = count.cumsum()
    begins = ends - count
    side = np.arange(len(steps)).repeat(count)
    step = np.arange(len(side)) - begins[side]
    cuts = step.nonzero()[0]
    up = np.sign(steps)[side]
    leg_wedges = (wedges[side] + up * step) % len(sector.beams)
    cut_side = side[cuts]
    beam = (leg_wedges[cuts] + (up[cuts] < 0)) % len(sector.beams)
    way = z[cut_side + 1] - z[cut_side]
    way /= np.abs(way)
    passes, slant = (z[cut_side].conj() * way).imag, (sector.along[beam].conj() * way).imag
    return Course(
        numbers, z, real, wedges, side, leg_wedges, begins, ends - 1, cuts, beam, passes, slant
    )
