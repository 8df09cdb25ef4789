"""Where a border crosses the outline of a sector, found by sweeping around the robot (R12).

Between two beams a sector has a single side at its far ends, and one at its near ends: whether a
leg of a border crosses it follows from how deep inside the leg begins and ends. So all crossings
are found in arrays, from the course of the border from beam to beam.
"""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np

from semtopo.course import UNCLEAR, Course, UnclearError
from semtopo.sector import Sector
from semtopo.types import Complexes, Flags, Floats, Integers

BELOW_ONE = 1 - 2**-40
"""A crossing lies on the side on which it was found, also where rounding says otherwise."""


class Crossings(NamedTuple):
    """Where a border crosses the outline of a sector, in order along the border, (crossings,) each.

    That is up to rounding.

    `place` is the number of the vertex of the border before, and the share of the side from there;
    `around` is the same on the outline. `z` is the point, in m from the robot. `enters` says
    whether the border enters the sector there. `inside` says of each vertex of the course whether
    it lies inside.
    """

    place: Floats
    around: Floats
    z: Complexes
    enters: Flags
    inside: Flags


def sweep(course: Course, sector: Sector) -> Crossings | None:
    """Return where a border crosses a sector; `None` if none of it lies inside.

    Raises
    ------
    UnclearError
        A place of the border is so near to the outline that rounding decides on which side it is.
    """
    legs = _Legs(course, sector)
    fronts = [_Front(sector, course, legs, far=True)]
    if sector.near is not None:
        fronts.append(_Front(sector, course, legs, far=False))
    depths = [front.depths for front in fronts]
    least = depths[0] if len(depths) == 1 else np.minimum(*depths)
    if least.max() <= UNCLEAR and not (len(depths) > 1 and _through(depths, legs.real)):
        return None
    if any(np.abs(it).min() < UNCLEAR for it in depths):
        raise UnclearError
    found = [front.crossed() for front in fronts]
    if legs.gap is not None:
        found.append(_edges_crossed(course, sector, legs, least[course.at_cuts] > 0))
    return _in_order(found, least[course.at_vertices] > 0)


class _Legs:
    """Of the legs of a course, the wedge, and whether it is `real` and not in the gap.

    `gap` says which lie between the last and the first beam of a sector that is not closed. How far
    the line of a side passes by the robot is known at each cut, in m, and the sine of its angle
    with the beam, which has the same sign.
    """

    def __init__(self, course: Course, sector: Sector) -> None:
        """Put together what is known at vertices and at cuts."""
        self.wedges = np.empty(len(course.z) + len(course.sides), dtype=np.intp)
        self.wedges[course.at_vertices], self.wedges[course.at_cuts] = course.wedges, course.leads
        self.real = np.ones(len(self.wedges) - 1, dtype=np.bool_)
        self.real[course.at_vertices[:-1]] = course.real
        self.gap = None
        if not sector.closed:
            self.gap = self.wedges == len(sector.far) - 1
            self.real &= ~self.gap[:-1]
        self.ways = course.z[1:] - course.z[:-1]
        ways = self.ways[course.sides]
        ways /= np.abs(ways)
        self.passes = (course.z[course.sides].conj() * ways).imag
        self.slant = (sector.along[course.beams].conj() * ways).imag


Found: TypeAlias = tuple[Floats, Floats, Complexes, Flags]
"""Place, place around, point and whether it enters, of crossings in any order."""


class _Front:
    """The far or the near ends of a sector: one side in each wedge, none in the gap.

    `depths` (stops,) says how far inside each stop of a course is, in m: at a beam, how far the end
    of the front is from the side that is cut there.
    """

    def __init__(self, sector: Sector, course: Course, legs: _Legs, *, far: bool) -> None:
        """Lay the sides out, and see how deep the course goes."""
        self._course, self._legs, self._far = course, legs, far
        radii = sector.far if far or sector.near is None else sector.near
        self._numbers = None if far else sector.near_sides
        self._start = radii * sector.along
        self._chord = np.empty_like(self._start)
        np.subtract(self._start[1:], self._start[:-1], out=self._chord[:-1])
        self._chord[-1] = self._start[0] - self._start[-1]
        inward = 1.0 if far else -1.0
        self._normal = self._chord.conj() * (-1j * inward / np.abs(self._chord))
        self._offset = (self._normal * self._start).real
        at_vertices = (self._normal[course.wedges] * course.z).real
        at_vertices -= self._offset[course.wedges]
        if legs.gap is not None:
            at_vertices[course.wedges == len(radii) - 1] = -inward
        out = legs.passes - radii[course.beams] * legs.slant
        self.depths = np.empty(len(legs.wedges))
        self.depths[course.at_vertices] = at_vertices
        self.depths[course.at_cuts] = out * np.copysign(1.0, -inward * legs.slant)

    def crossed(self) -> Found:
        """Return where the course crosses the sides."""
        inside, course = self.depths > 0, self._course
        legs = ((inside[1:] != inside[:-1]) & self._legs.real).nonzero()[0]
        side, wedge = (
            course.at_vertices.searchsorted(legs, side="right") - 1,
            self._legs.wedges[legs],
        )
        start, way = course.z[side], self._legs.ways[side]
        normal, chord = self._normal[wedge], self._chord[wedge]
        share = (self._offset[wedge] - (normal * start).real) / (normal * way).real
        z = start + share * way
        along = ((z - self._start[wedge]) / chord).real
        if self._numbers is None:
            around = _placed(wedge, along)
        else:
            around = _placed(self._numbers[wedge], 1 - along)
        return _placed(course.numbers[side], share), around, z, inside[legs + 1]


def _through(depths: list[Floats], real: Flags) -> bool:
    """Say whether a leg goes through both fronts of a sector, from one side to the other."""
    through = real.copy()
    for depth in depths:
        one, other = depth[:-1], depth[1:]
        through &= (np.maximum(one, other) > UNCLEAR) & (np.minimum(one, other) < -UNCLEAR)
    return bool(through.any())


def _placed(side: Integers, share: Floats) -> Floats:
    """Return places on sides: their number, and which share of them lies before."""
    return np.minimum(np.maximum(share, 0.0), BELOW_ONE) + side


def _edges_crossed(course: Course, sector: Sector, legs: _Legs, inside: Flags) -> Found:
    """Return where a course comes from the gap of a sector that is not closed, or goes there.

    `inside` says of each cut whether it lies between the near and the far end of its beam.
    """
    gap = np.zeros(0, dtype=np.bool_) if legs.gap is None else legs.gap
    comes = gap[course.at_cuts - 1]
    chosen = ((comes != gap[course.at_cuts]) & inside).nonzero()[0]
    side, beam = course.sides[chosen], course.beams[chosen]
    radii = legs.passes[chosen] / legs.slant[chosen]
    z = radii * sector.along[beam]
    start = course.z[side]
    share = ((z - start) / legs.ways[side]).real
    near = 0.0 if sector.near is None else sector.near[beam]
    out = (radii - near) / (sector.far[beam] - near)
    first = beam == 0
    edge = np.where(first, len(sector.border.xy) - 2, len(sector.far) - 1)
    around = _placed(edge, np.where(first, out, 1 - out))
    return _placed(course.numbers[side], share), around, z, comes[chosen]


def _in_order(found: list[Found], inside: Flags) -> Crossings:
    """Return crossings in order along the border, as those of one front are already."""
    if len(found) == 1:
        return Crossings(*found[0], inside)
    place = np.concatenate([it[0] for it in found])
    around = np.concatenate([it[1] for it in found])
    z = np.concatenate([it[2] for it in found])
    enters = np.concatenate([it[3] for it in found])
    order = place.argsort()
    return Crossings(place[order], around[order], z[order], enters[order], inside)
