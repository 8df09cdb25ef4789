"""The zones of one scan z_u (Alg. 2, l. 36-42; R6), and the one where the robot is.

A zone is the union of the strips of its label; where places that do not touch are zones of their
own (R14), of those in one place. This room remembers nothing: what was known before is the business
of `metric`.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from math import inf

import numpy as np
import shapely

from semtopo.border import Border, taken_together
from semtopo.fusion import Extent
from semtopo.geometry import Region, apart, union
from semtopo.sector import Sector, outlines, sector_of
from semtopo.strips import Strips
from semtopo.traced import traced
from semtopo.types import (
    NOWHERE,
    Identity,
    Integers,
    MappingOptions,
    Point,
    SeenName,
)

SAME_DISTANCE = 1e-9
"""m; far above what rounding does to a distance indoors, far below what a sensor can tell."""

OFF = 100 * SAME_DISTANCE
"""m; a side between beams that are up to HALF_TURN apart passes by at 1/50 of that, at least."""


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
    def holds_robot(self) -> bool:
        """Whether a sector begins at the robot."""
        return any(sector.near is None for sector in self.sectors)

    @property
    def is_off_robot(self) -> bool:
        """Whether it is plain from the sectors that the zone is farther away than SAME_DISTANCE."""
        nears = [sector.near for sector in self.sectors]
        return bool(nears) and all(near is not None and near.min() > OFF for near in nears)

    @property
    def name(self) -> SeenName:
        """What names the zone in its scan."""
        return (self.label, self.part)


def zones_of(strips: Strips, options: MappingOptions) -> tuple[list[Zone], Integers]:
    """Return the zones in the order of their names, and in which of them each interval lies.

    That is its place in the list, or `NOWHERE` (Alg. 2, l. 36-42; R14).
    """
    labels, label = strips.scan.labels, strips.scan.intervals.label
    zones: list[Zone] = []
    owner = np.full(len(label), NOWHERE)
    for number, chosen in sorted(
        places_of(label[strips.left]).items(), key=lambda it: labels[it[0]]
    ):
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


def places_of(numbers: Integers) -> dict[int, Integers]:
    """Return where each number stands in an array, ascending."""
    if len(numbers) == 0:
        return {}
    if (numbers == numbers[0]).all():
        return {int(numbers[0]): np.arange(len(numbers))}
    order = numbers.argsort(kind="stable")
    ordered = numbers[order]
    first = [0, *((ordered[1:] != ordered[:-1]).nonzero()[0] + 1).tolist(), len(order)]
    return {int(ordered[one]): order[one:end] for one, end in pairwise(first)}


def nearest_zone(zones: list[Zone], position: Point) -> Zone | None:
    """Return the zone nearest to the robot (Alg. 3, l. 1-2; ties by name, R7).

    Samples stand at equal distances, so ties are common; rounding must not decide them.
    """
    distances: list[float] = []
    held = any(zone.holds_robot for zone in zones)
    for zone in zones:
        if zone.holds_robot:  # no other is nearer, and the first by name is meant
            distances.append(0.0)
            break
        apart = held and zone.is_off_robot
        distances.append(inf if apart else zone.region.distance(shapely.Point(position)))
    near = min(distances, default=0.0) + SAME_DISTANCE
    return next((zone for zone, far in zip(zones, distances, strict=False) if far <= near), None)
