"""Routes: the best of all that there are; held against trying out everything."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from semtopo.atlas import Atlas
from semtopo.errors import NoRouteError, UnknownZoneError
from semtopo.graph import Passage
from semtopo.mapper import MapState
from semtopo.route import Place, Route, RouteRequest, find_routes
from tests.atlases import Edge, atlas

ZONES = "abcdef"


def best(atlas: Atlas, source: str, target: str) -> Route:
    """Return the best route from the origin in one zone to the origin in another."""
    start, goal = Place(source, (0.0, 0.0)), Place(target, (0.0, 0.0))
    return find_routes(atlas, RouteRequest(start=start, goals=(goal,)))[0]


@st.composite
def atlases(draw: st.DrawFn) -> Atlas:
    """Draw up to six zones and some passages; points lie on a small lattice, so that ties occur."""
    zones = ZONES[: draw(st.integers(2, 6))]
    pairs = [(source, target) for source in zones for target in zones if source != target]
    chosen = draw(st.lists(st.sampled_from(pairs), unique=True, max_size=14))
    points = st.tuples(st.integers(0, 3).map(float), st.integers(0, 3).map(float))
    return atlas([(source, target, draw(points)) for source, target in chosen], zones)


def all_ways(
    atlas: Atlas, source: str, target: str, taken: tuple[Passage, ...] = ()
) -> Iterator[tuple[Passage, ...]]:
    """Yield the passages of every way that visits no zone twice."""
    here = taken[-1].target if taken else source
    if here == target:
        yield taken
        return
    seen = {source, *(passage.target for passage in taken)}
    for passage in atlas.state.graph.passages.values():
        if passage.source == here and passage.target not in seen:
            yield from all_ways(atlas, source, target, (*taken, passage))


def length(way: tuple[Passage, ...]) -> float:
    points = [(0.0, 0.0), *(passage.point for passage in way), (0.0, 0.0)]
    return math.fsum(math.dist(one, other) for one, other in pairwise(points))


@given(drawn=atlases(), data=st.data())
def test_a_route_is_the_best_of_all(drawn: Atlas, data: st.DataObject) -> None:
    source, target = (data.draw(st.sampled_from(sorted(drawn.state.graph.nodes))) for _ in "ab")
    possible = list(all_ways(drawn, source, target))
    if not possible:
        with pytest.raises(NoRouteError):
            best(drawn, source, target)
        return
    found = best(drawn, source, target)
    assert found.length == pytest.approx(min(map(length, possible)))
    assert found.length == length(found.passages)
    assert (found.zones[0], found.zones[-1]) == (source, target)
    assert [(one.source, one.target) for one in found.passages] == list(pairwise(found.zones))


def test_edges_lead_one_way() -> None:
    drawn = atlas([("a", "b", (0, 0))])
    assert best(drawn, "a", "b").zones == ("a", "b")
    with pytest.raises(NoRouteError):
        best(drawn, "b", "a")


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


def test_a_long_corridor() -> None:
    """Five hundred zones in a row, which no recursion would survive."""
    zones = [f"z{number}" for number in range(500)]
    edges: list[Edge] = [(*pair, (number / 2, 0.0)) for number, pair in enumerate(pairwise(zones))]
    route = best(atlas(edges), "z0", "z499")
    assert (len(route.passages), route.length) == (499, 498.0)
