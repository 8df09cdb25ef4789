"""Routes through an atlas: which passages lead from one place to another, and what that costs.

In come an atlas and a request; out go routes, the best first. A zone is a region, not a point, so
distances do not add up from zone to zone: the search goes from passage to passage, and what counts
is the way between the two inside a zone.
"""

from __future__ import annotations

import heapq
import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import count, pairwise

import shapely

from semtopo.atlas import Atlas, Limits
from semtopo.errors import NoRouteError, UnknownZoneError
from semtopo.graph import Passage, PassageKey
from semtopo.types import Point


@dataclass(frozen=True, slots=True)
class Place:
    """A zone, or a point in it in m, map frame; a zone alone stands for its widest place."""

    zone_id: str
    point: Point | None = None


@dataclass(frozen=True, slots=True)
class CostModel:
    """What a way costs: so much for each metre, and so much for each passage."""

    length: float = 1.0
    passage: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class RouteRequest:
    """Asks for routes from a place to the nearest of some goals.

    They go through the zones `via` in that order, enter no zone of `avoid_zones` and use no passage
    of `avoid_passages`. With `two_way`, passages may be used against their direction. `radius` is
    that of the robot, in m; `alternatives` says how many routes are wanted, at most.
    """

    start: Place
    goals: tuple[Place, ...]
    via: tuple[str, ...] = ()
    avoid_zones: frozenset[str] = frozenset()
    avoid_passages: frozenset[PassageKey] = frozenset()
    two_way: bool = False
    cost: CostModel = field(default_factory=CostModel)
    radius: float = 0.0
    alternatives: int = 1


@dataclass(frozen=True, slots=True)
class Route:
    """A way through `zones` by `passages`: one zone more than passages, all in order.

    `points` are the start, the passage points and the goal; `length` in m is that of the way
    between them inside the zones, and `cost` what the cost model and restrictions make of it.
    """

    zones: tuple[str, ...]
    passages: tuple[Passage, ...]
    points: tuple[Point, ...]
    cost: float
    length: float

    @property
    def source(self) -> str:
        """The zone in which it begins."""
        return self.zones[0]

    @property
    def target(self) -> str:
        """The zone in which it ends."""
        return self.zones[-1]

    @property
    def backwards(self) -> tuple[Passage, ...]:
        """The passages that are used against their direction, in order."""
        uses = zip(self.zones, self.passages, strict=False)
        return tuple(passage for zone_id, passage in uses if passage.source != zone_id)


def find_routes(atlas: Atlas, request: RouteRequest) -> tuple[Route, ...]:
    """Return the best routes, the best first: at least one, at most `request.alternatives`.

    Raises
    ------
    UnknownZoneError
        A zone of the request is not in the map.
    NoRouteError
        No sequence of passages leads to any goal.
    """
    for zone_id in _zones_of(request):
        if zone_id not in atlas.state.graph.nodes:
            raise UnknownZoneError("the map has no such zone")
    search = _Search(atlas, request)
    best = search.run()
    if best is None:
        raise NoRouteError("no passages lead from the one zone to the other")
    return (best,)


def widest_place(atlas: Atlas, zone_id: str) -> Point:
    """Return the centre of the largest circle in a zone, in m, map frame."""
    line = shapely.maximum_inscribed_circle(atlas.state.metric.zones[zone_id].region)
    x, y = shapely.get_coordinates(line)[0]
    return (float(x), float(y))


def _zones_of(request: RouteRequest) -> Iterator[str]:
    yield request.start.zone_id
    yield from (goal.zone_id for goal in request.goals)
    yield from request.via


_State = tuple[str, Point, int]
"""A zone, where it was entered, and how many of `via` lie behind."""


class _Search:
    def __init__(self, atlas: Atlas, request: RouteRequest) -> None:
        self._atlas, self._request = atlas, request
        self._limits: Limits = atlas.limits
        self._leaving: dict[str, list[tuple[Passage, str]]] = {}
        closed = self._limits.closed_passages | request.avoid_passages
        for passage in atlas.state.graph.passages.values():
            if passage.key in closed:
                continue
            self._leaving.setdefault(passage.source, []).append((passage, passage.target))
            if request.two_way:
                self._leaving.setdefault(passage.target, []).append((passage, passage.source))

    def run(self) -> Route | None:
        """Return the best route, if there is one."""
        request, order = self._request, count()
        goals = [(goal.zone_id, self._point(goal)) for goal in request.goals]
        first = (request.start.zone_id, self._point(request.start), 0)
        closed_zones = self._limits.closed_zones | request.avoid_zones
        waiting: list[tuple[float, int, _State | None, tuple[Passage, ...], tuple[Point, ...]]] = []
        waiting.append((0.0, next(order), self._arrived(first), (), (first[1],)))
        seen: set[_State] = set()
        while waiting:
            cost, _, state, passages, points = heapq.heappop(waiting)
            if state is None:
                return self._route(cost, passages, points)
            if state in seen:
                continue
            seen.add(state)
            zone_id, point, behind = state
            for end in [
                end for zone, end in goals if (zone, behind) == (zone_id, len(request.via))
            ]:
                total = cost + self._leg(zone_id, point, end)
                heapq.heappush(waiting, (total, next(order), None, passages, (*points, end)))
            for passage, entered in self._leaving.get(zone_id, ()):
                if entered in closed_zones:
                    continue
                step = self._leg(zone_id, point, passage.point) + request.cost.passage
                step *= self._limits.passage_factors.get(passage.key, 1.0)
                after = self._arrived((entered, passage.point, behind))
                way = ((*passages, passage), (*points, passage.point))
                heapq.heappush(waiting, (cost + step, next(order), after, *way))
        return None

    def _point(self, place: Place) -> Point:
        return place.point or widest_place(self._atlas, place.zone_id)

    def _arrived(self, state: _State) -> _State:
        zone_id, point, behind = state
        via = self._request.via
        while behind < len(via) and via[behind] == zone_id:
            behind += 1
        return (zone_id, point, behind)

    def _leg(self, zone_id: str, start: Point, end: Point) -> float:
        factor = self._limits.zone_factors.get(zone_id, 1.0)
        return self._request.cost.length * math.dist(start, end) * factor

    def _route(
        self, cost: float, passages: tuple[Passage, ...], points: tuple[Point, ...]
    ) -> Route:
        zones = [self._request.start.zone_id]
        for passage in passages:
            zones.append(passage.target if passage.source == zones[-1] else passage.source)
        length = math.fsum(math.dist(one, other) for one, other in pairwise(points))
        return Route(tuple(zones), passages, points, cost, length)
