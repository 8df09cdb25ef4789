"""Why there is no route: what is said of the gap is true."""

from __future__ import annotations

from dataclasses import replace

import networkx as nx
import numpy as np
import pytest
import shapely
from hypothesis import given

from semtopo.atlas import Atlas
from semtopo.errors.ways import ZONES_TOLD_MAX, MissingPassage, NoRouteError
from semtopo.mapper import MapState
from semtopo.metric import MappedZone, MetricMap
from semtopo.notes import Restriction, ZoneRef
from semtopo.route import Place, RouteRequest, find_routes
from semtopo.types import Occupancy
from tests.atlases import Edge, atlas
from tests.extents import marked
from tests.journeys import Journey, journeys
from tests.strategies import many


def refused(place: Atlas, source: str, target: str) -> NoRouteError:
    request = RouteRequest(start=Place(source), goals=(Place(target),))
    with pytest.raises(NoRouteError) as caught:
        find_routes(place, request)
    return caught.value


ROOMS: list[Edge] = [("a", "b", (0, 0)), ("c", "b", (1, 0)), ("c", "d", (2, 0)), ("e", "d", (3, 0))]


def test_both_sides_of_the_gap() -> None:
    error = refused(atlas(ROOMS), "a", "d")
    assert error.reachable == ("a", "b")
    assert error.reaching == ("c", "d", "e")
    assert error.missing == MissingPassage("b", "c", since=2)
    assert not error.restricted


def test_of_several_passages_the_wrong_way_the_first() -> None:
    place = atlas([("a", "b", (0, 0)), ("d", "b", (0, 0)), ("d", "a", (0, 0))])
    assert refused(place, "a", "d").missing == MissingPassage("b", "d", since=2)


def test_nothing_is_missing_where_nothing_leads_back() -> None:
    assert refused(atlas([("a", "b", (0, 0))], "abz"), "a", "z").missing is None


def test_what_is_closed_is_not_missing() -> None:
    """The passage is known; it may open again."""
    there_and_back: list[Edge] = [("a", "b", (0, 0)), ("b", "a", (0, 0))]
    limits = (Restriction("r", ("a", "b", 0), closed=True),)
    error = refused(atlas(there_and_back, restrictions=limits), "a", "b")
    assert (error.missing, error.restricted) == (None, True)
    limits = (Restriction("r", ZoneRef("b"), closed=True),)
    assert refused(atlas(there_and_back, restrictions=limits), "a", "b").restricted


def test_passages_against_their_direction_may_help() -> None:
    there: list[Edge] = [("a", "b", (0, 0))]
    assert refused(atlas(there), "b", "a").two_way
    assert not refused(atlas(there, "abz"), "a", "z").two_way
    closed = (Restriction("r", ("a", "b", 0), closed=True),)
    assert not refused(atlas(there, restrictions=closed), "b", "a").two_way
    request = RouteRequest(start=Place("a"), goals=(Place("z"),), two_way=True)
    with pytest.raises(NoRouteError) as caught:
        find_routes(atlas(there, "abz"), request)
    assert not caught.value.two_way


def test_the_gap_is_where_the_first_stop_cannot_be_reached() -> None:
    request = RouteRequest(start=Place("a"), goals=(Place("a"),), via=("b", "c"))
    with pytest.raises(NoRouteError) as caught:
        find_routes(atlas([*ROOMS, ("b", "a", (0, 0))]), request)
    assert caught.value.reachable == ("a", "b")
    assert caught.value.reaching == ("c",)


def test_few_zones_are_told_of_many() -> None:
    edges: list[Edge] = [("a", f"z{number}", (0, 0)) for number in range(300)]
    error = refused(atlas(edges, "b"), "a", "b")
    assert len(error.reachable) == 301
    told = error.facts["reachable"]
    assert isinstance(told, tuple)
    assert len(told) == ZONES_TOLD_MAX


@given(journey=journeys())
def test_what_is_said_is_true(journey: Journey) -> None:
    try:
        find_routes(journey.atlas, journey.request)
    except NoRouteError as error:
        _check(journey, error)


def leads_both_ways(journey: Journey) -> bool:
    """Say whether there is a route once passages may be used against their direction."""
    try:
        find_routes(journey.atlas, replace(journey.request, two_way=True, radius=None))
    except NoRouteError:
        return False
    return True


def _check(journey: Journey, error: NoRouteError) -> None:
    graph = journey.atlas.state.graph
    assert error.two_way == leads_both_ways(journey)
    assert not set(error.reachable) & set(error.reaching)
    if error.missing is not None:
        pair = (error.missing.source, error.missing.target)
        assert pair not in graph.pairs
        assert pair[::-1] in graph.pairs
        assert pair[0] in error.reachable
        assert pair[1] in error.reaching
    restricted = bool(journey.atlas.restrictions or journey.request.avoid_zones)
    if restricted or journey.request.avoid_passages or journey.request.via:
        return
    assert not error.restricted
    zones: nx.DiGraph[str] = nx.DiGraph()
    zones.add_nodes_from(graph.nodes)
    zones.add_edges_from(graph.pairs)
    if journey.request.two_way:
        zones.add_edges_from(pair[::-1] for pair in graph.pairs)
    start, goals = journey.request.start.zone_id, {it.zone_id for it in journey.request.goals}
    assert set(error.reachable) == {start, *nx.descendants(zones, start)}
    assert set(error.reaching) == goals.union(*(nx.ancestors(zones, goal) for goal in goals))


def test_gaps_are_drawn() -> None:
    seen = {"missing": 0, "plain": 0, "restricted": 0, "two_way": 0}

    @many
    @given(journey=journeys())
    def look(journey: Journey) -> None:
        try:
            find_routes(journey.atlas, journey.request)
        except NoRouteError as error:
            seen["missing"] += error.missing is not None
            seen["restricted"] += error.restricted
            seen["two_way"] += error.two_way
            seen["plain"] += not (journey.atlas.restrictions or journey.request.avoid_zones)

    look()
    assert min(seen.values()) >= 8, seen


def walled(zone_id: str, box: tuple[float, float, float, float], free: str) -> MappedZone:
    """Return a rectangle whose sides are walls, but for the one that is a frontier."""
    west, south, east, north = box
    sides = {"east": [(east, y) for y in np.linspace(south, north, 5)],
             "west": [(west, y) for y in np.linspace(south, north, 5)]}  # fmt: skip
    region = shapely.Polygon([(west, south), *sides["east"], *reversed(sides["west"])])
    ends = sides[free][1:-1] if free in sides else []
    corners = [(x, y) for x in (west, east) for y in (south, north)]
    others = [xy for side in sides.values() for xy in side[1:-1] if xy not in ends]
    claims = dict.fromkeys([*corners, *others], Occupancy.OBSTACLE)
    ground = marked(region, {**claims, **dict.fromkeys(ends, Occupancy.FREE)})
    return MappedZone(zone_id, zone_id, ground, 1, 1)


def test_the_frontier_nearest_to_the_gap() -> None:
    """Of two rooms that can be reached, the one with the frontier towards the goal is named."""
    place = atlas([("a", "b", (0, 0))], "abz")
    zones = [
        walled("a", (0, 0, 2, 4), "east"), walled("b", (-2, 0, 0, 4), "west"),
        walled("z", (5, 0, 7, 4), "none"),
    ]  # fmt: skip
    metric = MetricMap({zone.zone_id: zone for zone in zones})
    error = refused(Atlas(MapState(1, metric, place.state.graph)), "a", "z")
    assert error.frontier is not None
    assert (error.frontier.zone_id, error.frontier.towards) == ("a", "z")
    assert error.frontier.distance == pytest.approx(3)
    assert error.frontier.point[0] == 2
    assert 0 <= error.frontier.point[1] <= 4


def test_no_frontier_where_everything_is_walled() -> None:
    place = atlas([], "az")
    zones = [walled("a", (0, 0, 2, 4), "none"), walled("z", (5, 0, 7, 4), "none")]
    metric = MetricMap({zone.zone_id: zone for zone in zones})
    assert refused(Atlas(MapState(1, metric, place.state.graph)), "a", "z").frontier is None
