"""The sensor map M_u: polygonal zones seen in one scan (Alg. 2, l. 36-42; R6).

In comes a scan; out go its zones, and which of them the beams linked. This room remembers nothing:
what was known before is the business of `metric` and `graph`.

A zone is the union of the strips of its label; where places that do not touch are zones of their
own (R14), of those in one place.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from itertools import pairwise

import numpy as np
import shapely

from semtopo.border import Border, taken_together
from semtopo.crossings import SeenDoorways, seen_doorways
from semtopo.fusion import Extent
from semtopo.geometry import Polygons, Region, apart, nearest_point, union
from semtopo.scan import Scan
from semtopo.sector import Sector, outlines, sector_of
from semtopo.strips import Strips, find_strips
from semtopo.traced import traced
from semtopo.types import (
    NOWHERE,
    Edges,
    Identity,
    Integers,
    MappingOptions,
    Point,
    SeenName,
)

SAME_DISTANCE = 1e-9
"""m; far above what rounding does to a distance indoors, far below what a sensor can tell."""


@dataclass(frozen=True, slots=True, eq=False)
class Zone:
    """A zone of one scan z_u: its label, and its extent.

    `part` tells zones of one label apart, from 0, the nearest first; there are several only where
    each place is a zone of its own (R14). `sectors` are what the extent consists of, if the scan
    has samples and its strips form chains.
    """

    label: str
    extent: Extent
    part: int = 0
    sectors: tuple[Sector, ...] = ()

    @property
    def region(self) -> Region:
        """The extent of the zone in m, map frame."""
        return self.extent.region

    @property
    def border(self) -> Border:
        """The border of the region."""
        return self.extent.border

    @property
    def name(self) -> SeenName:
        """What names the zone in its scan."""
        return (self.label, self.part)


@dataclass(frozen=True, slots=True, eq=False)
class Link:
    """Evidence in one scan that one passes from `source` to `target`.

    `ground` makes the `strips` when asked for: most links are known. The parts say which zones of
    these labels are meant.
    """

    source: str
    target: str
    ground: Callable[[], Polygons]
    source_part: int = 0
    target_part: int = 0

    @property
    def strips(self) -> Polygons:
        """The ground of the target that one enters, as polygons."""
        return self.ground()

    @property
    def ends(self) -> tuple[SeenName, SeenName]:
        """What names source and target in their scan."""
        return (self.source, self.source_part), (self.target, self.target_part)

    def nearest_point(self, position: Point) -> Point:
        """Return the point of the entered part that is nearest to the robot (R11)."""
        return nearest_point(union(self.strips), position)


@dataclass(frozen=True, slots=True, eq=False)
class SensorMap:
    """The zones of one scan M_u, sorted by name, with the position p_r it was taken from.

    `here` is the label s_r of the nearest zone, `None` if the scan shows no zone (R8). `links` are
    the edges that the scan speaks for, by the option `edges` (R15), `doorways` the ground that it
    shows between zones. `here_part` says which zone of that label is meant.
    """

    position: Point
    zones: tuple[Zone, ...]
    here: str | None
    links: tuple[Link, ...]
    doorways: tuple[SeenDoorways, ...] = ()
    here_part: int = 0

    @property
    def here_name(self) -> SeenName | None:
        """What names the zone where the robot is."""
        return None if self.here is None else (self.here, self.here_part)


def extract(scan: Scan, options: MappingOptions) -> SensorMap:
    """Build the zones of a scan and find the one where the robot is (Alg. 2, l. 36-42).

    Zones not above `min_zone_area` are left out (R9); so is all that has no area.
    """
    strips = find_strips(scan)
    zones, owner = _zones(strips, options)
    here = _nearest(zones, scan.position)
    if here is None:
        return SensorMap(scan.position, (), None, ())
    if options.edges is Edges.ADJACENT:
        links = tuple(_adjacent_links(strips, zones, owner))
    else:
        links = tuple(_seen_links(here, strips, zones, owner))
    doorways = seen_doorways(strips, owner, [zone.name for zone in zones])
    return SensorMap(scan.position, tuple(zones), here.label, links, tuple(doorways), here.part)


def _zones(strips: Strips, options: MappingOptions) -> tuple[list[Zone], Integers]:
    """Return the zones in the order of their names, and in which of them each interval lies.

    That is its place in the list, or `NOWHERE` (Alg. 2, l. 36-42; R14).
    """
    labels, label = strips.scan.labels, strips.scan.intervals.label
    zones: list[Zone] = []
    owner = np.full(len(label), NOWHERE)
    for number, chosen in sorted(_places(label[strips.left]).items(), key=lambda it: labels[it[0]]):
        extent, sectors = _extent(strips, chosen)
        if options.identity is Identity.LABEL:
            places = [(extent, (label == number).nonzero()[0])]
        else:
            places = list(_parts(extent, strips, chosen))
        least = options.min_zone_area
        large = [it for it in places if least == 0 or it[0].region.area > least]
        for part, (place, mine) in enumerate(large):
            owner[mine] = len(zones)
            swept = sectors if place is extent and not strips.scan.exact else ()
            zones.append(Zone(labels[number], place, part, swept))
    return zones, owner


def _extent(strips: Strips, chosen: Integers) -> tuple[Extent, tuple[Sector, ...]]:
    """Return the union of strips, of which there is at least one, and its sectors if it has any."""
    scan = strips.scan
    chains = strips.chains(chosen)
    if not chains:
        region: Region = shapely.orient_polygons(union(strips.polygons(chosen)))
        border = traced(region, [outlines(scan, strips.left[chosen], strips.right[chosen])])
        return Extent(border, region), ()
    sectors = tuple(sector_of(scan, chain, closed=closed) for chain, closed in chains)
    if len(sectors) == 1:
        return Extent(sectors[0].border), sectors
    return Extent(taken_together([sector.border for sector in sectors])), sectors


def _parts(extent: Extent, strips: Strips, chosen: Integers) -> Iterator[tuple[Extent, Integers]]:
    """Yield the places of one label that do not touch, the nearest first, with their intervals."""
    places = apart(extent.region)
    if len(places) == 1:
        yield extent, np.union1d(strips.left[chosen], strips.right[chosen])
        return
    place = shapely.Point(strips.scan.position)
    places.sort(key=lambda part: (part.distance(place), part.bounds))
    inside = shapely.centroid(strips.polygons(chosen))
    for part in places:
        mine = chosen[shapely.intersects(part, inside)]
        region: Region = shapely.orient_polygons(part)
        border = traced(region, [extent.border])
        yield Extent(border, region), np.union1d(strips.left[mine], strips.right[mine])


def _places(numbers: Integers) -> dict[int, Integers]:
    """Return where each number stands in an array, ascending."""
    if len(numbers) == 0:
        return {}
    if (numbers == numbers[0]).all():
        return {int(numbers[0]): np.arange(len(numbers))}
    order = numbers.argsort(kind="stable")
    ordered = numbers[order]
    first = [0, *((ordered[1:] != ordered[:-1]).nonzero()[0] + 1).tolist(), len(order)]
    return {int(ordered[one]): order[one:end] for one, end in pairwise(first)}


def _nearest(zones: list[Zone], position: Point) -> Zone | None:
    """Return the zone nearest to the robot (Alg. 3, l. 1-2; ties by name, R7).

    Samples stand at equal distances, so ties are common; rounding must not decide them.
    """
    distances: list[float] = []
    for zone in zones:
        holds = any(sector.near is None for sector in zone.sectors)
        distances.append(0.0 if holds else zone.region.distance(shapely.Point(position)))
        if holds:  # no other is nearer, and the first by name is meant
            break
    near = min(distances, default=0.0) + SAME_DISTANCE
    return next((zone for zone, far in zip(zones, distances, strict=False) if far <= near), None)


def _seen_links(here: Zone, strips: Strips, zones: list[Zone], owner: Integers) -> Iterator[Link]:
    """Yield a link from here to every other zone (Alg. 3, l. 13-29)."""
    places = _places(owner[strips.left]) if len(zones) > 1 else {}
    for number, zone in enumerate(zones):
        if zone is not here and number in places:
            yield _link(here, zone, partial(strips.polygons, places[number]))


def _adjacent_links(strips: Strips, zones: list[Zone], owner: Integers) -> Iterator[Link]:
    """Yield a link for every pair of zones with strips that lead from one to the other (R15).

    Both beams of a strip must come through: one alone may have slipped through a wall. The strips
    that lead there are what one enters, and not all that is seen of the target.
    """
    entered = strips.entering()
    source, target = owner[strips.left[entered] - 1], owner[strips.left[entered]]
    known = (source != NOWHERE) & (target != NOWHERE) & (source != target)
    known &= source == owner[strips.right[entered] - 1]
    entered, pairs = entered[known], (target * len(zones) + source)[known]
    for pair, found in _places(pairs).items():
        target_number, source_number = divmod(pair, len(zones))
        ground = partial(strips.polygons, entered[found])
        yield _link(zones[source_number], zones[target_number], ground)


def _link(source: Zone, target: Zone, ground: Callable[[], Polygons]) -> Link:
    return Link(source.label, target.label, ground, source.part, target.part)
