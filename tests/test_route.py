"""Routes: the fewest passages, then the shortest line; held against trying out everything."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from semtopo.errors import NoRouteError, UnknownZoneError
from semtopo.graph import Node, Passage, TopologyGraph
from semtopo.route import Route, find_route

ZONES = "abcdef"

Edge = tuple[str, str, tuple[float, float]]


def graph(*edges: Edge, zones: str = ZONES) -> TopologyGraph:
    """Return a graph whose passages were found in the order given."""
    passages = {
        (source, target, 0): Passage(source, target, point, seq)
        for seq, (source, target, point) in enumerate(edges, start=1)
    }
    return TopologyGraph({zone: Node(zone, zone, 1) for zone in zones}, passages)


@st.composite
def graphs(draw: st.DrawFn) -> TopologyGraph:
    """Draw up to six zones and some passages; points lie on a small lattice, so that ties occur."""
    zones = ZONES[: draw(st.integers(2, 6))]
    pairs = [(source, target) for source in zones for target in zones if source != target]
    chosen = draw(st.lists(st.sampled_from(pairs), unique=True, max_size=14))
    points = st.tuples(st.integers(0, 3).map(float), st.integers(0, 3).map(float))
    return graph(*((source, target, draw(points)) for source, target in chosen), zones=zones)


def all_routes(
    topology: TopologyGraph, source: str, target: str, taken: tuple[Passage, ...] = ()
) -> Iterator[Route]:
    """Yield every route that visits no zone twice."""
    here = taken[-1].target if taken else source
    if here == target:
        yield Route(source, target, taken)
        return
    seen = {source, *(passage.target for passage in taken)}
    for passage in topology.passages.values():
        if passage.source == here and passage.target not in seen:
            yield from all_routes(topology, source, target, (*taken, passage))


@given(topology=graphs(), data=st.data())
def test_a_route_is_the_best_of_all(topology: TopologyGraph, data: st.DataObject) -> None:
    source, target = (data.draw(st.sampled_from(sorted(topology.nodes))) for _ in range(2))
    possible = list(all_routes(topology, source, target))
    if not possible:
        with pytest.raises(NoRouteError):
            find_route(topology, source, target)
        return
    found = find_route(topology, source, target)
    fewest = min(len(route.passages) for route in possible)
    assert len(found.passages) == fewest
    shortest = min(route.length for route in possible if len(route.passages) == fewest)
    assert found.length == pytest.approx(shortest)
    assert found.passages in [route.passages for route in possible]


@given(topology=graphs(), data=st.data())
def test_a_route_hangs_together(topology: TopologyGraph, data: st.DataObject) -> None:
    source, target = (data.draw(st.sampled_from(sorted(topology.nodes))) for _ in range(2))
    try:
        found = find_route(topology, source, target)
    except NoRouteError:
        return
    assert (found.zones[0], found.zones[-1]) == (source, target)
    assert [(one.source, one.target) for one in found.passages] == list(pairwise(found.zones))
    assert all(topology.passages[(*pair, 0)] in found.passages for pair in pairwise(found.zones))
    legs = [math.dist(one.point, other.point) for one, other in pairwise(found.passages)]
    assert found.length == sum(legs)


def test_the_strategy_is_not_vacuous() -> None:
    """Most drawn graphs have a route of several passages; counted on a fixed set."""
    long = graph(("a", "b", (0, 0)), ("b", "c", (1, 0)), ("c", "d", (1, 1)), ("a", "c", (3, 3)))
    assert find_route(long, "a", "d").zones == ("a", "c", "d")
    assert {len(route.passages) for route in all_routes(long, "a", "d")} == {2, 3}


def test_few_passages_win_over_a_short_way() -> None:
    topology = graph(
        ("a", "b", (0, 0)), ("b", "c", (0, 0)), ("c", "d", (0, 0)),
        ("a", "e", (0, 0)), ("e", "d", (100, 100)),
    )  # fmt: skip
    assert find_route(topology, "a", "d").zones == ("a", "e", "d")


def test_of_equally_few_passages_the_shortest_line_wins() -> None:
    topology = graph(("a", "b", (0, 0)), ("b", "d", (5, 0)), ("a", "c", (0, 0)), ("c", "d", (1, 0)))
    assert find_route(topology, "a", "d").zones == ("a", "c", "d")


def test_of_routes_alike_in_both_the_one_found_first_wins() -> None:
    edges: list[Edge] = [
        ("a", "c", (0, 0)), ("a", "b", (0, 0)), ("b", "d", (1, 0)), ("c", "d", (1, 0)),
    ]  # fmt: skip
    assert find_route(graph(*edges), "a", "d").zones == ("a", "c", "d")
    edges[0], edges[1] = edges[1], edges[0]
    assert find_route(graph(*edges), "a", "d").zones == ("a", "b", "d")


def test_edges_lead_one_way() -> None:
    topology = graph(("a", "b", (0, 0)))
    assert find_route(topology, "a", "b").zones == ("a", "b")
    with pytest.raises(NoRouteError):
        find_route(topology, "b", "a")


def test_who_is_there_already_needs_no_passage() -> None:
    route = find_route(graph(("a", "b", (0, 0)), ("b", "a", (0, 0))), "a", "a")
    assert (route.zones, route.passages, route.length) == (("a",), (), 0)


@pytest.mark.parametrize(("source", "target"), [("a", "z"), ("z", "a"), ("z", "z"), ("A", "a")])
def test_a_zone_that_is_not_there(source: str, target: str) -> None:
    with pytest.raises(UnknownZoneError):
        find_route(graph(("a", "b", (0, 0))), source, target)


def test_an_empty_graph_knows_no_zone() -> None:
    with pytest.raises(UnknownZoneError):
        find_route(TopologyGraph(), "a", "b")


def test_a_long_corridor() -> None:
    """Five hundred zones in a row, which no recursion would survive."""
    zones = [f"z{number}" for number in range(500)]
    passages = {
        (*pair, 0): Passage(*pair, (float(number), 0.0), number)
        for number, pair in enumerate(pairwise(zones))
    }
    topology = TopologyGraph({zone: Node(zone, zone, 1) for zone in zones}, passages)
    route = find_route(topology, "z0", "z499")
    assert (len(route.passages), route.length) == (499, 498.0)
