"""The dense path of a route goes into every zone that is to be visited, in turn."""

from __future__ import annotations

import math
from itertools import pairwise

import pytest
import shapely
from shapely import LineString

from semtopo.dense import find_path, path_of, too_narrow
from semtopo.doorways import Doorway
from semtopo.errors.ways import OutsideError, TooNarrowError
from semtopo.inset import inset
from semtopo.route import Place, Route, RouteRequest, find_routes
from tests.test_ways import ZONES, hall

RADIUS = 0.3


def routed(*via: str, goal: str = "b", radius: float | None = RADIUS, gap: float = 1.0) -> Route:
    """Return the best route from the hall through some zones, by passages both ways."""
    start, end = Place("hall", (6.0, 1.0)), Place(goal, (10.0, 1.0) if goal == "b" else None)
    request = RouteRequest(start=start, goals=(end,), via=via, radius=radius, two_way=True)
    return find_routes(hall(gap), request)[0]


@pytest.mark.parametrize("via", [(), ("a",), ("b",), ("a", "b"), ("a", "hall", "a"), ("a", "a")])
def test_a_path_goes_into_the_zones_it_is_to_go_through(via: tuple[str, ...]) -> None:
    route = routed(*via)
    assert route.path is not None
    line = LineString(route.path.points)
    assert route.path.length == pytest.approx(line.length)
    assert route.path.clearance >= RADIUS
    assert all(one != other for one, other in pairwise(route.path.points))
    free = shapely.union_all([*ZONES.values(), *(it.region for it in _doors())])
    assert free.buffer(1e-9).covers(line)
    place = 0.0  # along the path; each visit comes after the one before
    for zone_id in via:
        inside = line.intersection(inset(ZONES[zone_id], RADIUS).buffer(1e-6))
        ends = [line.project(shapely.Point(xy)) for xy in shapely.get_coordinates(inside)]
        assert max(ends) >= place
        place = min(end for end in ends if end >= place)


def _doors() -> list[Doorway]:
    return list(hall().state.metric.doorways.values())


def test_without_zones_to_go_through_a_path_is_straight() -> None:
    route = routed()
    assert route.path is not None
    assert route.path.length < 5.0
    far = routed("a")
    assert far.path is not None
    assert far.path.length > 2 * math.dist((6, 1), (3.6, 1.7))


def test_where_a_robot_is_already_it_need_not_go() -> None:
    assert routed("hall").path == routed().path


def test_a_zone_to_go_through_may_be_too_narrow_to_be_in() -> None:
    narrow = routed("a", radius=None)
    with pytest.raises((TooNarrowError, OutsideError)):
        path_of(hall(), narrow, ("a",), 2.1)
    assert find_path(hall(), narrow, ("a",), 2.1) is None


def test_doorways_are_told_that_are_too_narrow() -> None:
    route = routed("a", radius=None)
    assert not list(too_narrow(hall(1.0), route, 0.3))
    assert set(too_narrow(hall(0.5), route, 0.3)) == {it.key for it in route.passages}
