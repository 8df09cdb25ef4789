"""Fusion: the union of what is known of a zone with what a scan shows of it (R12).

Sectors of a scan are taken in by sweeping around the robot, at the cost of what is near. What comes
too near to each other for that is united by GEOS, and so is all that is no sector; there the marks
are read off both borders.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import shapely

from semtopo.border import Border, arranged, within
from semtopo.course import Course, UnclearError, course_of
from semtopo.geometry import NO_AREA, Region, polygonal
from semtopo.seams import Seams, joined
from semtopo.sector import Sector
from semtopo.sweep import Crossings, sweep
from semtopo.traced import traced
from semtopo.types import Point


@dataclass(frozen=True, eq=False)
class Extent:
    """A region in m, map frame, with its border: the vertices of both are in the same order.

    If the region is not `given`, it is made from the border when asked for: most scans only go from
    border to border.
    """

    border: Border
    given: Region | None = None

    @classmethod
    def of(cls, region: Region) -> Extent:
        """Return the extent of a region of whose border nothing is known."""
        turned: Region = shapely.orient_polygons(region)
        return cls(Border.of(turned), turned)

    @cached_property
    def region(self) -> Region:
        """The region."""
        return within(self.border) if self.given is None else self.given


def fuse(known: Extent, seen: Extent, sectors: Sequence[Sector] = ()) -> Extent:
    """Return the union of two extents, or the first itself where the second adds no area (R12).

    If there are `sectors`, they are what the second consists of.
    """
    if not sectors:
        return _united(known, seen)
    for sector in sectors:
        try:
            known = _swept(known, sector)
        except UnclearError:
            known = _united(known, Extent(sector.border))
    return known


def _united(known: Extent, seen: Extent) -> Extent:
    """Return the union of two extents as GEOS has it."""
    region = polygonal(shapely.union(known.region, seen.region))
    if region.area - known.region.area <= NO_AREA:
        return known
    turned: Region = shapely.orient_polygons(region)
    return Extent(traced(turned, [known.border, seen.border]), turned)


def _swept(known: Extent, sector: Sector) -> Extent:
    """Return the union of an extent with a sector, swept.

    Raises
    ------
    UnclearError
        The two come too near to each other, or meet nowhere.
    """
    course = course_of(known.border, sector)
    found = None if course is None else sweep(course, sector)
    if course is None or found is None:
        return _covering(known, sector.inner_point)
    if len(found.place) == 0:
        raise UnclearError
    seams = Seams.on(known.border, found.place)
    around = Seams.on(sector.border, found.around, len(known.border.xy))
    for ring in range(len(sector.border.begins) - 1):
        if ring not in around.rings:
            x, y = sector.border.xy[sector.border.begins[ring]]
            _covering(known, (x, y))
    whole = [*_whole(known.border, course, found, seams.rings)]
    return Extent(arranged(joined(seams, around, found, sector.position, whole)))


def _covering(known: Extent, place: Point) -> Extent:
    """Return an extent that has a place; raise if it has not."""
    if not shapely.contains_xy(known.region, *place):
        raise UnclearError
    return known


def _whole(border: Border, course: Course, found: Crossings, crossed: set[int]) -> Iterator[int]:
    """Yield the rings that stay as they are: not crossed, and not inside the sector."""
    first = course.numbers.searchsorted(border.begins)
    for ring in range(len(border.begins) - 1):
        is_near = first[ring] < first[ring + 1]
        if ring not in crossed and not (is_near and found.inside[first[ring]]):
            yield ring
