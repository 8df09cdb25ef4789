"""Random atlases and requests for routes, and their answer by trying out every way."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from typing import TypeVar

import networkx as nx
import numpy as np
import shapely
from hypothesis import strategies as st

from semtopo.atlas import Atlas
from semtopo.geometry import Region, polygonal
from semtopo.graph import Passage
from semtopo.notes import LabelRef, Restriction, ZoneRef
from semtopo.route import CostModel, Place, Route, RouteRequest
from semtopo.types import Point
from tests.atlases import atlas
from tests.visibility import link, visibility_graph

NOW = 1_000.0

_WHOLE = shapely.box(-1, -1, 4, 4)
_SLITS = [
    shapely.box(0.25, -2, 0.75, 2.5), shapely.box(1.25, 0.5, 1.75, 5),
    shapely.box(0.25, 0.25, 2.75, 0.75), shapely.box(-2, 1.25, 2.5, 1.75),
]  # fmt: skip
SHAPES: list[Region] = [_WHOLE, *(polygonal(_WHOLE.difference(slit)) for slit in _SLITS)]
"""A square and squares with walls in them; no wall touches a point with whole coordinates."""

_points = st.tuples(st.integers(0, 3).map(float), st.integers(0, 3).map(float))
"""So few that ties occur."""

_costs = st.builds(CostModel, st.sampled_from([0.0, 1.0, 2.5]), st.sampled_from([0.0, 1.0, 7.0]))


@cache
def _walks(shape: int) -> dict[Point, dict[Point, float]]:
    """Return the lengths of the shortest paths inside a shape, between its points."""
    region = SHAPES[shape]
    graph = visibility_graph(region)
    for point in [(float(x), float(y)) for x in range(4) for y in range(4)]:
        others = np.array(list(graph.nodes))
        link(graph, region, np.broadcast_to(point, others.shape), others)
    return dict(nx.all_pairs_dijkstra_path_length(graph))


def walk(shape: int, start: Point, end: Point) -> float:
    """Return the length of the shortest path inside a shape."""
    return _walks(shape)[start][end]


@dataclass(frozen=True)
class Journey:
    """A request on an atlas; `shapes` gives the number of each zone's shape."""

    atlas: Atlas
    request: RouteRequest
    shapes: dict[str, int]


@st.composite
def journeys(draw: st.DrawFn) -> Journey:
    """Draw two to five zones with up to nine passages, some restrictions, and any request."""
    zones = "abcde"[: draw(st.integers(2, 5))]
    zone = st.sampled_from(zones)
    shapes = {it: draw(st.integers(0, len(SHAPES) - 1)) for it in zones}
    pairs = [(one, other, n) for one in zones for other in zones if one != other for n in (0, 1)]
    count = st.integers(len(zones) - 1, 9)
    size = min(draw(count), len(pairs))
    keys = draw(st.lists(st.sampled_from(pairs), unique=True, min_size=size, max_size=size))
    place = st.builds(Place, zone, _points)
    request = RouteRequest(
        start=draw(place),
        goals=tuple(draw(st.lists(place, min_size=1, max_size=2))),
        via=tuple(draw(st.lists(zone, max_size=2))),
        avoid_zones=frozenset(draw(_few(zone))),
        avoid_passages=frozenset(draw(_few(st.sampled_from(keys)))),
        two_way=draw(st.booleans()),
        cost=draw(_costs),
    )  # fmt: skip
    made = atlas(
        [(one, other, draw(_points), number) for one, other, number in keys],
        {it: SHAPES[shapes[it]] for it in zones},
        {it: draw(st.sampled_from("xyz")) for it in zones},
        restrictions=tuple(draw(_few(_restrictions(zone, st.sampled_from(keys))))),
        now=NOW,
    )
    return Journey(made, request, shapes)


Drawn = TypeVar("Drawn")


def _few(drawn: st.SearchStrategy[Drawn]) -> st.SearchStrategy[list[Drawn]]:
    return st.lists(drawn, max_size=2) | st.just([])


def _restrictions(
    zone: st.SearchStrategy[str], key: st.SearchStrategy[tuple[str, str, int]]
) -> st.SearchStrategy[Restriction]:
    on = key | st.builds(ZoneRef, zone) | st.builds(LabelRef, st.sampled_from("xyz"))
    return st.builds(
        Restriction,
        id=st.just("r"),
        on=on,
        closed=st.sampled_from([False, False, True]),
        factor=st.sampled_from([0.25, 1.0, 3.0]),
        expires_at=st.sampled_from([None, None, NOW - 1, NOW, NOW + 1]),
    )


def least_cost(journey: Journey) -> float:
    """Return the least cost of all ways that repeat no passage between two stops; else infinity."""
    request = journey.request
    best = math.inf
    start = (request.start.zone_id, request.start.point)
    waiting = [(start[0], start[1], _behind(request, 0, start[0]), 0.0, frozenset[object]())]
    while waiting:
        zone, point, behind, paid, used = waiting.pop()
        assert point is not None
        if paid >= best:
            continue
        if behind == len(request.via):
            for goal in request.goals:
                if goal.zone_id == zone:
                    assert goal.point is not None
                    best = min(best, paid + leg_cost(journey, zone, point, goal.point, None))
        for passage, after in _open_from(journey, zone):
            state = (passage.key, after, behind)
            if state not in used:
                cost = paid + leg_cost(journey, zone, point, passage.point, passage)
                stops = _behind(request, behind, after)
                waiting.append((after, passage.point, stops, cost, used | {state}))
    return best


def leg_cost(
    journey: Journey, zone: str, start: Point, end: Point, passage: Passage | None
) -> float:
    """Return what it costs to go inside a zone, and by a passage if one ends the way."""
    model = journey.request.cost
    cost = model.length * walk(journey.shapes[zone], start, end)
    cost += 0.0 if passage is None else model.passage
    for one in _holding(journey.atlas):
        if _is_on(journey.atlas, one, zone) or (passage is not None and one.on == passage.key):
            cost *= one.factor
    return cost


def route_cost(journey: Journey, route: Route) -> float:
    """Return what a route costs, leg by leg; check that it may be gone."""
    request = journey.request
    behind = _behind(request, 0, route.zones[0])
    cost = 0.0
    legs = zip(route.zones, pairwise(route.points), (*route.passages, None), strict=True)
    for number, (zone, ends, passage) in enumerate(legs):
        cost += leg_cost(journey, zone, *ends, passage)
        if passage is not None:
            after = route.zones[number + 1]
            assert (passage, after) in _open_from(journey, zone)
            behind = _behind(request, behind, after)
    assert behind == len(request.via)
    assert route.points[0] == request.start.point
    assert Place(route.target, route.points[-1]) in request.goals
    return cost


def _behind(request: RouteRequest, behind: int, zone: str) -> int:
    while behind < len(request.via) and request.via[behind] == zone:
        behind += 1
    return behind


def _open_from(journey: Journey, zone: str) -> list[tuple[Passage, str]]:
    """Return the passages by which one may leave a zone, each with where it leads."""
    request, place = journey.request, journey.atlas
    closed = {one.on for one in _holding(place) if one.closed} | request.avoid_passages
    shut = set(request.avoid_zones)
    shut |= {
        it for it in place.state.graph.nodes
        for one in _holding(place) if one.closed and _is_on(place, one, it)
    }  # fmt: skip
    ways: list[tuple[Passage, str]] = []
    for passage in place.state.graph.passages.values():
        if passage.source == zone:
            ways.append((passage, passage.target))
        if passage.target == zone and request.two_way:
            ways.append((passage, passage.source))
    return [(passage, to) for passage, to in ways if passage.key not in closed and to not in shut]


def _holding(place: Atlas) -> Iterator[Restriction]:
    return (one for one in place.restrictions if one.expires_at is None or one.expires_at > NOW)


def _is_on(place: Atlas, one: Restriction, zone: str) -> bool:
    if isinstance(one.on, ZoneRef):
        return one.on.zone_id == zone
    return isinstance(one.on, LabelRef) and one.on.label == place.state.graph.nodes[zone].label
