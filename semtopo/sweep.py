"""Where a border crosses the outline of a sector, found by sweeping around the robot (R12).

Between two beams a sector has a single side at its far ends, and one at its near ends: whether a
piece of border crosses it follows from how deep inside the piece begins and ends. So all crossings
are found in arrays, from the course of the border from beam to beam.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from semtopo.course import UNCLEAR, Course, UnclearError
from semtopo.sector import Sector
from semtopo.types import Complexes, Flags, Floats, Integers

BELOW_ONE = 1 - 2**-40
"""A crossing lies on the side on which it was found, also where rounding says otherwise."""


@dataclass(frozen=True, slots=True, eq=False)
class Crossings:
    """Where a border crosses the outline of a sector, in order along the border, (crossings,) each.

    `place` is the number of the vertex of the border before, and the share of the side from there;
    `around` is the same on the outline. `z` is the point, in m from the robot. `enters` says
    whether the border enters the sector there. `inside` says of each vertex of the course but the
    last whether it lies inside.
    """

    place: Floats
    around: Floats
    z: Complexes
    enters: Flags
    inside: Flags

    def __len__(self) -> int:
        """Return how many there are."""
        return len(self.place)


def sweep(course: Course, sector: Sector) -> Crossings | None:
    """Return where a border crosses a sector; `None` if none of it lies inside.

    Raises
    ------
    UnclearError
        A place of the border is so near to the outline that rounding decides on which side it is.
    """
    gap = None if sector.closed else course.leg_wedges == len(sector.beams) - 1
    fronts = [_Front(sector, course, gap, far=True)]
    if sector.near is not None:
        fronts.append(_Front(sector, course, gap, far=False))
    depths = [front.depths for front in fronts]
    real = course.real[course.side]
    least = depths[0] if sector.near is None else np.minimum(*depths)
    if not ((least > UNCLEAR) & real).any() and not _through(depths, real):
        return None
    if any(((np.abs(it) < UNCLEAR) & real).any() for it in depths):
        raise UnclearError
    found = [front.crossed(real) for front in fronts]
    if gap is not None:
        inside = np.maximum(least[0, course.cuts], least[1, course.cuts - 1]) > 0
        found.append(_edges_crossed(course, sector, gap, inside))
    return _in_order(found, least[0, course.begins] > 0)


def _through(depths: list[Floats], real: Flags) -> bool:
    """Say whether a leg goes through both fronts of a sector, from one side to the other."""
    if len(depths) == 1:
        return False
    deepest, shallowest = (find(depths, axis=1) for find in (np.max, np.min))
    flips = (deepest > UNCLEAR) & (shallowest < -UNCLEAR)
    return bool((flips[0] & flips[1] & real).any())


Found: TypeAlias = tuple[Floats, Floats, Complexes, Flags]
"""Place, place around, point and whether it enters, of crossings in any order."""


class _Front:
    """The far or the near ends of a sector: one side in each wedge, none in the gap.

    `depths` (2, legs) says how far inside each leg of a course begins and ends, in m.
    """

    def __init__(self, sector: Sector, course: Course, gap: Flags | None, *, far: bool) -> None:
        """Lay the sides out, and see how deep the course goes."""
        radii = sector.far if far or sector.near is None else sector.near
        self._course, self._inward = course, 1.0 if far else -1.0
        self._numbers = np.arange(len(radii)) if far else sector.near_sides
        self._start = radii * sector.along
        self._chord = np.concatenate([self._start[1:], self._start[:1]]) - self._start
        self._normal = self._chord / (1j * np.abs(self._chord))
        self._offset = (self._normal.conj() * self._start).real
        wedges, cuts = course.wedges, course.cuts
        out = (self._normal[wedges].conj() * course.z).real
        at_vertices = self._inward * (self._offset[wedges] - out)
        self.depths = np.empty((2, len(course.side)))
        self.depths[0, course.begins] = at_vertices[:-1]
        self.depths[1, course.ends] = at_vertices[1:]
        # at a beam, how far the end of the front is from the side
        out = course.passes - radii[course.beam] * course.slant
        at_cuts = -self._inward * out * np.sign(course.slant)
        self.depths[0, cuts] = self.depths[1, cuts - 1] = at_cuts
        if gap is not None:
            self.depths[:, gap] = -self._inward

    def crossed(self, real: Flags) -> Found:
        """Return where the course crosses the sides."""
        inside = self.depths > 0
        legs = ((inside[0] != inside[1]) & real).nonzero()[0]
        side, wedge = self._course.side[legs], self._course.leg_wedges[legs]
        start = self._course.z[side]
        way = self._course.z[side + 1] - start
        normal = self._normal[wedge].conj()
        share = (self._offset[wedge] - (normal * start).real) / (normal * way).real
        z = start + share * way
        chord = self._chord[wedge]
        along = (chord.conj() * (z - self._start[wedge])).real / (chord.conj() * chord).real
        if self._inward < 0:
            along = 1 - along
        numbers = self._course.numbers[side]
        return _placed(numbers, share), _placed(self._numbers[wedge], along), z, inside[1][legs]


def _placed(side: Integers, share: Floats) -> Floats:
    """Return places on sides: their number, and which share of them lies before."""
    return np.minimum(np.maximum(share, 0.0), BELOW_ONE) + side


def _edges_crossed(course: Course, sector: Sector, gap: Flags, inside: Flags) -> Found:
    """Return where a course comes from the gap of a sector that is not closed, or goes there.

    `inside` says of each cut whether it lies between the near and the far end of its beam.
    """
    cuts = course.cuts
    comes, goes = gap[cuts - 1] & ~gap[cuts], ~gap[cuts - 1] & gap[cuts]
    chosen = ((comes | goes) & inside & course.real[course.side[cuts]]).nonzero()[0]
    side, beam = course.side[cuts[chosen]], course.beam[chosen]
    radii = course.passes[chosen] / course.slant[chosen]
    z = radii * sector.along[beam]
    start = course.z[side]
    way = course.z[side + 1] - start
    share = ((z - start) * way.conj()).real / (way * way.conj()).real
    near = 0.0 if sector.near is None else sector.near[beam]
    out = (radii - near) / (sector.far[beam] - near)
    first = beam == 0
    edge = np.where(first, len(sector.border.xy) - 2, len(sector.beams) - 1)
    around = _placed(edge, np.where(first, out, 1 - out))
    return _placed(course.numbers[side], share), around, z, comes[chosen]


def _in_order(found: list[Found], inside: Flags) -> Crossings:
    """Return crossings in order along the border."""
    place, around, z, enters = found[0]
    if len(found) > 1:
        place = np.concatenate([it[0] for it in found])
        around = np.concatenate([it[1] for it in found])
        z = np.concatenate([it[2] for it in found])
        enters = np.concatenate([it[3] for it in found])
    order = place.argsort()
    return Crossings(place[order], around[order], z[order], enters[order], inside)
