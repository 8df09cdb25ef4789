"""The ground of a zone: how long the ways inside it are.

In come a zone of the map and the doorways at it; out go lengths. They are those of the shortest
path through the zone and its doorways, for a robot without extent. Where the map knows no such
path, because a zone is in pieces or a doorway was never crossed by two beams, the way is straight.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from typing import NamedTuple
from weakref import WeakKeyDictionary

import numpy as np
import shapely
from shapely import LineString

from semtopo.doorways import Doorway
from semtopo.ellipse import clipped, ellipse
from semtopo.errors import SemtopoError
from semtopo.freespace import FreeSpace
from semtopo.geometry import TOUCH, Polygons, Region, joined, nearest_point, widest_place
from semtopo.metric import MappedZone, MetricMap
from semtopo.types import Point

LENGTHS_KEPT = 10_000
"""Lengths in memory, of one zone."""

SPACES_KEPT = 256
"""Free spaces in memory, of all zones; each is a triangulation."""

BREADTH = 1.0
"""m; of the ellipse in which a way is looked for first."""

WIDER = 3
"""Times; so much broader it becomes, if there is no way in it."""

LEAST_WORK = 100
"""Vertices; a window with few of them takes as long as with so many."""

MAPS_KEPT = 16
"""Maps in memory whose doorways are listed by zone."""


@dataclass(eq=False)
class Ground:
    """A zone and the doorways at it, in m, map frame.

    A way is first looked for near the straight one, where the ground is made free space for it
    alone; all of it is made free space when that would have been less work.
    """

    zone: Region
    doorways: tuple[Doorway, ...]
    _lengths: dict[tuple[Point, Point], float] = field(default_factory=dict)
    _spent: int = 0

    @cached_property
    def parts(self) -> Polygons:
        """The regions of the zone and its doorways."""
        doors = (doorway.region for doorway in self.doorways)
        return np.array([self.zone, *doors], dtype=np.object_)

    @cached_property
    def region(self) -> Region:
        """The zone and its doorways as one region."""
        region = joined(self.parts)
        shapely.prepare(region)
        return region

    @cached_property
    def size(self) -> int:
        """How many vertices there are in all."""
        return int(shapely.get_num_coordinates(self.parts).sum())

    @cached_property
    def widest_place(self) -> Point:
        """The centre of the largest circle in the zone."""
        return widest_place(self.zone)

    def length(self, start: Point, end: Point) -> float:
        """Return the length in m of the way between two points."""
        known = self._lengths.get((start, end))
        if known is None:
            known = self._measured(start, end)
            if len(self._lengths) < LENGTHS_KEPT:
                self._lengths[start, end] = known
        return known

    def _measured(self, start: Point, end: Point) -> float:
        straight = math.dist(start, end)
        if straight == 0 or self.zone.covers(LineString([start, end])):
            return straight
        length = math.hypot(straight, BREADTH)
        while self._spent < self.size:
            parts = clipped(self.parts, ellipse(start, end, length))
            self._spent += LEAST_WORK + int(shapely.get_num_coordinates(parts).sum())
            leg = _leg(FreeSpace(joined(parts)), start, end) if len(parts) else None
            if leg is not None and leg.proof <= length:
                return leg.length
            wider = WIDER * math.sqrt(length**2 - straight**2)
            length = math.hypot(straight, wider) if leg is None else leg.proof + TOUCH
        leg = _leg(_space(self), start, end)
        return straight if leg is None else leg.length


class _Leg(NamedTuple):
    """A way in m, and how long ways must be looked for to know that none is shorter."""

    length: float
    proof: float


def _leg(space: FreeSpace, start: Point, end: Point) -> _Leg | None:
    """Return the way through free space from where it is nearest to the start, and so at the end.

    The circles around both ends with nothing of free space in them are in the ellipse, too, if its
    axis is longer than the straight way by their diameters.
    """
    straight = math.dist(start, end)
    if space.region.covers(LineString([start, end])):
        return _Leg(straight, straight)
    enter, leave = (nearest_point(space.region, point) for point in (start, end))
    try:
        path = space.find(enter, leave)
    except SemtopoError:
        return None
    if path is None:
        return None
    before, after = math.dist(start, enter), math.dist(leave, end)
    length = max(straight, before + path.length + after)
    return _Leg(length, max(length, straight + 2 * before, straight + 2 * after))


@lru_cache(maxsize=SPACES_KEPT)
def _space(ground: Ground) -> FreeSpace:
    return FreeSpace(ground.region)


_grounds: WeakKeyDictionary[MappedZone, Ground] = WeakKeyDictionary()


def ground_of(metric: MetricMap, zone_id: str) -> Ground:
    """Return the ground of a zone of a map; as long as nothing of it changes, the same one."""
    zone, doorways = metric.zones[zone_id], _doorways_by_zone(metric).get(zone_id, ())
    known = _grounds.get(zone)
    if known is None or known.doorways != doorways:
        known = _grounds[zone] = Ground(zone.region, doorways)
    return known


@lru_cache(maxsize=MAPS_KEPT)
def _doorways_by_zone(metric: MetricMap) -> dict[str, tuple[Doorway, ...]]:
    found: dict[str, list[Doorway]] = {}
    for doorway in metric.doorways.values():
        for end in dict.fromkeys(doorway.ends):
            found.setdefault(end, []).append(doorway)
    return {zone_id: tuple(doorways) for zone_id, doorways in found.items()}


def zone_at(metric: MetricMap, point: Point, among: Sequence[str]) -> str | None:
    """Return the zone, of some, in which a point in m lies; `None` if it is in none.

    Doorways count to the zones at their ends. A zone goes before a doorway; of several, the first.
    """
    inside = shapely.intersects_xy([metric.zones[zone].region for zone in among], *point)
    if len(among) and inside.any():
        return among[int(np.argmax(inside))]
    doors = _doorways_by_zone(metric)
    for zone in among:
        if any(shapely.intersects_xy(door.region, *point) for door in doors.get(zone, ())):
            return zone
    return None


def nearest_ground(metric: MetricMap, point: Point, among: Sequence[str]) -> Point | None:
    """Return the point of some zones that is nearest to a point in m; `None` if there are none."""
    if not among:
        return None
    regions = [metric.zones[zone].region for zone in among]
    apart = shapely.distance(regions, shapely.Point(point))
    return nearest_point(regions[int(np.argmin(apart))], point)
