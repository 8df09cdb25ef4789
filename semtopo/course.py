"""How a border runs around a robot: between which beams of a sector each of its sides lies.

In come the border of a region and a sector of a scan; out goes the course of the sides near the
sector, cut at the beams. Between two beams, a sector has but one far end and one near end; so what
a side can cross is known from its course.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from semtopo.border import Border
from semtopo.geometry import as_complex
from semtopo.sector import Sector
from semtopo.types import Complexes, Flags, Integers

UNCLEAR = 1e-11
"""m; ten times what rounding does to a place within a kilometre of the origin."""

NEARLY_HALF_TURN = math.pi - 1e-6
"""rad; a side that turns so far around the robot passes by at no distance."""


class UnclearError(Exception):
    """A border and a sector come too near to each other to tell which is farther out."""


class Course(NamedTuple):
    """The sides of a border near a sector: from each of some vertices to the next, if `real`.

    Of the vertices, `numbers` (n,) are the places in the border, `z` where they are, in m from the
    robot, and `wedges` after which beam of the sector. Sides are cut at the beams: of the cuts, in
    order, `sides` (m,) says which side it is, `beams` at which beam, and `leads` to which wedge.
    Vertices and cuts together are stops: `at_vertices` and `at_cuts` are their places among these.
    From each to the next goes a leg.
    """

    numbers: Integers
    z: Complexes
    real: Flags
    wedges: Integers
    sides: Integers
    beams: Integers
    leads: Integers
    at_vertices: Integers
    at_cuts: Integers


def course_of(border: Border, sector: Sector) -> Course | None:
    """Return the course of the sides of a border near a sector; `None` if there are none.

    Raises
    ------
    UnclearError
        A side comes too near to the robot, or a vertex to the first or last beam.
    """
    z = as_complex(border.xy) - sector.position
    numbers, real = _near(z, border, sector)
    if len(numbers) == 0:
        return None
    z = z[numbers]
    if not sector.closed:
        _check_edges(z, sector)
    turned = z * -sector.along[0].conj()  # so the cut of the angle is the first beam
    bearings = np.arctan2(turned.imag, turned.real)
    wedges = (sector.bearings - math.pi).searchsorted(bearings, side="right") - 1
    np.maximum(wedges, 0, out=wedges)  # on the first beam
    steps = wedges[1:] - wedges[:-1]
    turns = bearings[1:] - bearings[:-1]
    wide = (np.abs(turns) > NEARLY_HALF_TURN).nonzero()[0]
    if len(wide):  # the short way leads over the first beam
        if (np.abs(turns[wide]) < 2 * math.pi - NEARLY_HALF_TURN)[real[wide]].any():
            raise UnclearError
        steps[wide] -= np.sign(turns[wide]).astype(np.intp) * len(sector.far)
    steps *= real
    return _cut(numbers, z, real, wedges, steps, len(sector.far))


def _near(z: Complexes, border: Border, sector: Sector) -> tuple[Integers, Flags]:
    """Return the vertices of sides near a sector, and at which of them such a side begins.

    They are where `z` says, in m from the robot.
    """
    reach = sector.far.max()
    xy = z.view(np.float64)  # x and y in turn
    low, high = xy < -reach, xy > reach
    apart = low[2:] & low[:-2]
    apart |= high[2:] & high[:-2]
    near = np.zeros(len(z), dtype=np.bool_)
    np.equal(apart.view(np.uint16), 0, out=near[:-1])  # neither x nor y
    near[border.begins[1:] - 1] = False  # no side leads from one ring to the next
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
    numbers: Integers, z: Complexes, real: Flags, wedges: Integers, steps: Integers, count: int
) -> Course:
    """Cut sides at the beams: each goes so many `steps` from wedge to wedge, down if negative."""
    cuts = np.abs(steps)
    so_far = cuts.cumsum()
    at_vertices = np.arange(len(z))
    at_vertices[1:] += so_far
    sides = np.arange(len(steps)).repeat(cuts)
    step = np.arange(1, len(sides) + 1) - (so_far - cuts)[sides]
    down = steps[sides] < 0
    leads = (wedges[sides] + np.where(down, -step, step)) % count
    beams = (leads + down) % count
    return Course(
        numbers, z, real, wedges, sides, beams, leads, at_vertices, at_vertices[sides] + step
    )
