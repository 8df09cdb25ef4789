"""Routes: the best of all that there are; held against trying out everything."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import combinations, pairwise
from random import Random
from typing import Any

import networkx as nx
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from semtopo.atlas import Atlas
from semtopo.errors import InvalidOptionError, InvalidRestrictionError, UnknownZoneError
from semtopo.errors.ways import NoRouteError
from semtopo.finder import SHARED_MAX
from semtopo.graph import Passage
from semtopo.mapper import MapState
from semtopo.notes import LabelRef, Restriction, ZoneRef
from semtopo.route import CostModel, Place, Route, RouteRequest, find_routes, widest_place
from semtopo.types import Point
from tests.atlases import Edge, atlas
from tests.journeys import Journey, journeys, least_cost, route_cost, walk
from tests.strategies import many

ORIGIN: Point = (0.0, 0.0)


def best(atlas: Atlas, source: str, target: str, **more: Any) -> Route:  # noqa: ANN401 -- as RouteRequest takes it
    """Return the best route from the origin in one zone to the origin in another."""
    goals = (Place(target, ORIGIN),)
    request = RouteRequest(start=Place(source, ORIGIN), goals=goals, **more)
    return find_routes(atlas, request)[0]


@settings(max_examples=200)
@given(journey=journeys())
def test_a_route_is_the_best_of_all(journey: Journey) -> None:
    least = least_cost(journey)
    if math.isinf(least):
        with pytest.raises(NoRouteError):
            find_routes(journey.atlas, journey.request)
        return
    route = find_routes(journey.atlas, journey.request)[0]
    assert route.cost == pytest.approx(least, rel=1e-4, abs=1e-4)
    assert route.cost == pytest.approx(route_cost(journey, route), abs=1e-6)
    assert route == find_routes(journey.atlas, journey.request)[0]


def test_journeys_are_not_vacuous() -> None:
    """Count what is drawn: routes of many passages, stops on the way, backwards, none at all."""
    seen = dict.fromkeys(["long", "via", "backwards", "none", "returning", "bent"], 0)

    @many
    @given(journey=journeys())
    def look(journey: Journey) -> None:
        try:
            route = find_routes(journey.atlas, journey.request)[0]
        except NoRouteError:
            seen["none"] += 1
            return
        straight = sum(math.dist(*ends) for ends in pairwise(route.points))
        seen["long"] += len(route.passages) > 1
        seen["via"] += bool(journey.request.via) and len(route.passages) > 1
        seen["backwards"] += bool(route.backwards)
        seen["returning"] += len(set(route.zones)) < len(route.zones)
        seen["bent"] += route.length > straight + 0.1

    look()
    assert min(seen.values()) >= 8, seen


@given(journey=journeys(), wanted=st.integers(2, 4))
def test_alternatives_are_really_different(journey: Journey, wanted: int) -> None:
    try:
        first = find_routes(journey.atlas, journey.request)[0]
    except NoRouteError:
        return
    routes = find_routes(journey.atlas, replace(journey.request, alternatives=wanted))
    assert routes[0] == first
    assert len(routes) <= wanted
    assert [it.cost for it in routes] == sorted(it.cost for it in routes)
    for route in routes:
        assert route.cost == pytest.approx(route_cost(journey, route), abs=1e-6)
    for one, other in combinations(routes, 2):
        assert one.passages != other.passages or one.points != other.points
        assert _shared(journey, one, other) <= SHARED_MAX + 1e-9


def _shared(journey: Journey, one: Route, other: Route) -> float:
    """Return how much of the shorter route both have in common."""
    legs = [set(zip(it.zones, pairwise(it.points), strict=True)) for it in (one, other)]
    same = sum(walk(journey.shapes[zone], *ends) for zone, ends in legs[0] & legs[1])
    return same / min(one.length, other.length) if same else 0.0


SQUARE = [("a", "b", (0, 2)), ("b", "d", (2, 2)), ("a", "c", (0, -3)), ("c", "d", (2, -3))]


def test_alternatives_are_the_ways_around() -> None:
    request = RouteRequest(
        start=Place("a", ORIGIN), goals=(Place("d", (3.0, 0.0)),), alternatives=5
    )
    routes = find_routes(atlas(SQUARE), request)
    assert [it.zones for it in routes] == [("a", "b", "d"), ("a", "c", "d")]


def test_few_passages_win_where_they_cost_much() -> None:
    place = atlas([
        ("a", "b", (0, 0)), ("b", "c", (0, 0)), ("c", "d", (0, 0)), ("a", "e", (0, 9)),
        ("e", "d", (0, 9)),
    ])  # fmt: skip
    assert best(place, "a", "d").zones == ("a", "b", "c", "d")
    assert best(place, "a", "d", cost=CostModel(1.0, 20.0)).zones == ("a", "e", "d")
    few = best(place, "a", "d", cost=CostModel(0.0, 1.0))
    assert (few.zones, few.cost, few.length) == (("a", "e", "d"), 2.0, 18.0)


def test_of_equal_cost_the_shorter_then_the_one_with_fewer_passages() -> None:
    place = atlas([("a", "b", (0, 1)), ("b", "d", (0, 1)), ("a", "c", (0, 2)), ("c", "d", (0, 2))])
    assert best(place, "a", "d", cost=CostModel(0.0, 1.0)).zones == ("a", "b", "d")
    place = atlas([("a", "b", (0, 1)), ("b", "c", (0, 1)), ("c", "d", (0, 2)), ("a", "d", (0, 2))])
    assert best(place, "a", "d").zones == ("a", "d")


def test_the_nearest_goal_wins() -> None:
    place = atlas([("a", "b", (0, 5)), ("a", "c", (0, 4)), ("c", "d", (0, 5))])
    goals = (Place("b", (0.0, 6.0)), Place("d", (0.0, 5.0)))
    route = find_routes(place, RouteRequest(start=Place("a", ORIGIN), goals=goals))[0]
    assert (route.target, route.points[-1]) == ("d", (0.0, 5.0))


def test_a_zone_without_a_point_is_its_widest_place() -> None:
    room, nook = shapely.box(0, 0, 4, 4), shapely.box(4, 1, 9, 2)
    place = atlas([("a", "b", (4.0, 2.0))], {"a": room.union(nook), "b": shapely.box(4, 2, 8, 10)})
    assert widest_place(place, "a") == pytest.approx((2, 2), abs=0.1)
    route = find_routes(place, RouteRequest(start=Place("a"), goals=(Place("b"),)))[0]
    assert route.points[0] == widest_place(place, "a")
    assert route.points[-1] == widest_place(place, "b")


def test_the_way_inside_a_zone_goes_around_what_stands_in_it() -> None:
    wall = shapely.box(0, 0, 10, 10).difference(shapely.box(4, -1, 6, 9))
    route = best(atlas([("a", "b", (8.0, 1.0))], {"a": wall}), "a", "b")
    around = math.dist((0, 0), (4, 9)) + 2 + math.dist((6, 9), (8, 1)) + math.dist((8, 1), ORIGIN)
    assert route.length == pytest.approx(around)


def test_edges_lead_one_way() -> None:
    place = atlas([("a", "b", (0, 1))])
    assert best(place, "a", "b").backwards == ()
    with pytest.raises(NoRouteError):
        best(place, "b", "a")
    route = best(place, "b", "a", two_way=True)
    assert (route.zones, route.backwards) == (("b", "a"), route.passages)


class TestRestrictions:
    """What is closed is not used, what costs more is used less, and both end when they expire."""

    PASSAGE = ("a", "b", 0)

    @pytest.mark.parametrize(
        "on", [PASSAGE, ZoneRef("b"), LabelRef("x")], ids=["passage", "zone", "label"]
    )
    @pytest.mark.parametrize(("closed", "factor"), [(True, 1.0), (False, 2.0)])
    def test_another_way(self, on: Any, closed: bool, factor: float) -> None:  # noqa: ANN401, FBT001 -- a case
        one = Restriction("r", on, closed, factor, expires_at=10.0)
        for now, zones in [(9.9, ("a", "c", "d")), (10.0, ("a", "b", "d"))]:
            place = atlas(SQUARE, labels={"b": "x"}, restrictions=(one,), now=now)
            assert best(place, "a", "d").zones == zones

    def test_factors_multiply(self) -> None:
        both = (
            Restriction("1", ZoneRef("b"), factor=3.0),
            Restriction("2", self.PASSAGE, factor=2),
        )
        route = best(atlas([("a", "b", (0, 1))], restrictions=both), "a", "b")
        assert (route.cost, route.length) == (2 * 1 + 3 * 1, 2)

    def test_one_may_leave_what_is_closed(self) -> None:
        place = atlas(SQUARE, restrictions=(Restriction("r", ZoneRef("a"), closed=True),))
        assert best(place, "a", "d").target == "d"
        assert best(place, "a", "a").zones == ("a",)

    def test_what_is_not_there_may_be_restricted(self) -> None:
        gone = (("z", "a", 0), ZoneRef("z"), LabelRef("z"))
        limits = tuple(Restriction(str(on), on, closed=True) for on in gone)
        assert best(atlas(SQUARE, restrictions=limits), "a", "d").zones == ("a", "b", "d")

    @pytest.mark.parametrize("factor", [0.0, -1.0, math.nan, math.inf, 1e7])
    def test_impossible_factors(self, factor: float) -> None:
        with pytest.raises(InvalidRestrictionError):
            Restriction("r", ZoneRef("a"), factor=factor)


def test_who_is_there_already_needs_no_passage() -> None:
    route = best(atlas([("a", "b", (0, 0)), ("b", "a", (0, 0))]), "a", "a")
    assert (route.zones, route.passages, route.length) == (("a",), (), 0)


@pytest.mark.parametrize(("source", "target"), [("a", "z"), ("z", "a"), ("z", "z"), ("A", "a")])
def test_a_zone_that_is_not_there(source: str, target: str) -> None:
    with pytest.raises(UnknownZoneError):
        best(atlas([("a", "b", (0, 0))]), source, target)


def test_an_empty_map_knows_no_zone() -> None:
    with pytest.raises(UnknownZoneError):
        best(Atlas(MapState()), "a", "b")


@pytest.mark.parametrize(
    "wrong",
    [
        {"goals": ()}, {"via": ("a",) * 21},
        {"alternatives": 0}, {"alternatives": 11}, {"radius": -0.1}, {"radius": math.nan},
        {"radius": 101.0},
    ],
)  # fmt: skip
def test_requests_that_ask_too_much(wrong: dict[str, Any]) -> None:
    with pytest.raises(InvalidOptionError):
        RouteRequest(**{"start": Place("a"), "goals": (Place("a"),), **wrong})


@pytest.mark.parametrize("costs", [(-1.0, 0.0), (0.0, -1.0), (math.nan, 0.0), (1e7, 0.0)])
def test_impossible_costs(costs: tuple[float, float]) -> None:
    with pytest.raises(InvalidOptionError):
        CostModel(*costs)


def test_a_long_corridor() -> None:
    """Five hundred zones in a row, which no recursion would survive."""
    zones = [f"z{number}" for number in range(500)]
    edges: list[Edge] = [(*pair, (number / 8, 0.0)) for number, pair in enumerate(pairwise(zones))]
    route = best(atlas(edges), "z0", "z499")
    assert (len(route.passages), route.length) == (499, 124.5)


def test_a_hall_of_a_thousand_doors() -> None:
    """Each room has a door to and from the hall: a million ways to pass through it."""
    doors = [(f"r{number}", (number / 16 - 32, 1.0)) for number in range(1_000)]
    edges: list[Edge] = [("hall", room, point) for room, point in doors]
    edges += [(room, "hall", (x, -y)) for room, (x, y) in doors]
    route = best(atlas(edges), "r0", "r999")
    assert route.zones == ("r0", "hall", "r999")


def manhattan(side: int, random: Random) -> Atlas:
    """Return a grid of square zones of 1 m with a door somewhere in each wall, one way or two."""
    zones = {(x, y): f"{x}-{y}" for x in range(side) for y in range(side)}
    edges: list[Edge] = []
    for (x, y), zone in zones.items():
        for dx, dy in ((1, 0), (0, 1)):
            other = zones.get((x + dx, y + dy))
            if other is not None:
                at = random.uniform(0.1, 0.9)
                point = (x + (dx or at), y + (dy or at))
                ways = [(zone, other, point), (other, zone, point)]
                edges += ways if random.random() < 0.8 else [random.choice(ways)]
    return atlas(edges, {zone: shapely.box(x, y, x + 1, y + 1) for (x, y), zone in zones.items()})


@pytest.mark.parametrize("side", [12, 100])
def test_a_grid_of_zones_against_networkx(side: int) -> None:
    random = Random(side)
    place = manhattan(side, random)
    turns = turns_of(place)
    zones = sorted(place.state.graph.nodes)
    for _ in range(10):
        start, goal = (Place(it, middle(place, it)) for it in random.sample(zones, 2))
        turns.add_weighted_edges_from(
            ("start", passage, math.dist(start.point or ORIGIN, passage.point))
            for passage in place.state.graph.passages.values()
            if passage.source == start.zone_id
        )
        turns.add_weighted_edges_from(
            (passage, "goal", math.dist(goal.point or ORIGIN, passage.point))
            for passage in place.state.graph.passages.values()
            if passage.target == goal.zone_id
        )
        route = find_routes(place, RouteRequest(start=start, goals=(goal,)))[0]
        assert route.length == pytest.approx(nx.bidirectional_dijkstra(turns, "start", "goal")[0])
        turns.remove_nodes_from(["start", "goal"])


def middle(place: Atlas, zone_id: str) -> Point:
    x, y = place.state.metric.zones[zone_id].region.centroid.coords[0]
    return (x, y)


def turns_of(place: Atlas) -> nx.DiGraph[object]:
    """Return the graph whose nodes are passages, each linked to those that may follow."""
    leaving: dict[str, list[Passage]] = {}
    for passage in place.state.graph.passages.values():
        leaving.setdefault(passage.source, []).append(passage)
    turns: nx.DiGraph[object] = nx.DiGraph()
    turns.add_weighted_edges_from(
        (one, other, math.dist(one.point, other.point))
        for one in place.state.graph.passages.values()
        for other in leaving.get(one.target, ())
    )
    return turns
