"""The sensor map M_u: the zones of one scan, and which of them the beams linked.

In comes a scan; out go its zones, links and doorways. This room remembers nothing: what was known
before is the business of `metric` and `graph`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial

from semtopo.crossings import SeenDoorways, seen_doorways
from semtopo.geometry import Polygons, nearest_point, union
from semtopo.scan import Scan
from semtopo.strips import Strips, find_strips
from semtopo.types import NOWHERE, Edges, Integers, MappingOptions, Point, SeenName
from semtopo.zones import Zone, nearest_zone, places_of, zones_of


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
    zones, owner = zones_of(strips, options)
    here = nearest_zone(zones, scan.position)
    if here is None:
        return SensorMap(scan.position, (), None, ())
    if options.edges is Edges.ADJACENT:
        links = tuple(_adjacent_links(strips, zones, owner))
    else:
        links = tuple(_seen_links(here, strips, zones, owner))
    doorways = seen_doorways(strips, owner, [zone.name for zone in zones])
    return SensorMap(scan.position, tuple(zones), here.label, links, tuple(doorways), here.part)


def _seen_links(here: Zone, strips: Strips, zones: list[Zone], owner: Integers) -> Iterator[Link]:
    """Yield a link from here to every other zone (Alg. 3, l. 13-29)."""
    places = places_of(owner[strips.left]) if len(zones) > 1 else {}
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
    for pair, found in places_of(pairs).items():
        target_number, source_number = divmod(pair, len(zones))
        ground = partial(strips.polygons, entered[found])
        yield _link(zones[source_number], zones[target_number], ground)


def _link(source: Zone, target: Zone, ground: Callable[[], Polygons]) -> Link:
    return Link(source.label, target.label, ground, source.part, target.part)
