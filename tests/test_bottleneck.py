"""Where the widest way is too narrow: on specimens whose widths are known."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from shapely import LineString, Polygon, affinity, box

from semtopo.bottleneck import find_bottleneck
from semtopo.geometry import Region, polygonal
from semtopo.types import Point


def walls(*doors: tuple[float, float]) -> Region:
    """Return rooms of 4 x 9 m in a row, walls of 0.2 m between, each with doors (y, width)."""
    space, solid = box(0, 0, 4.2 * len(doors) + 4, 9), []
    for number, (y, width) in enumerate(doors, start=1):
        wall = box(4.2 * number - 0.2, -1, 4.2 * number, 10)
        solid.append(wall.difference(box(-1, y - width / 2, 99, y + width / 2)))
    return polygonal(space.difference(shapely.union_all(solid)))


def test_of_several_doors_the_narrowest_is_named() -> None:
    region = walls((4, 0.8), (2, 0.5), (7, 0.9))
    found = find_bottleneck(region, (2, 4.5), (14.6, 4.5), 0.6)
    assert found is not None
    assert found.point == pytest.approx((8.3, 2), abs=0.11)
    assert found.width == pytest.approx(0.5, rel=0.01)


def test_of_two_doors_in_one_wall_the_wider_is_named() -> None:
    region = polygonal(walls((4, 0.5)).union(box(3.9, 7, 4.3, 7.7)))
    found = find_bottleneck(region, (2, 4), (6, 4), 0.6)
    assert found is not None
    assert found.point == pytest.approx((4.1, 7.35), abs=0.15)
    assert found.width == pytest.approx(0.7, rel=0.01)


def test_there_is_none_without_a_way() -> None:
    assert find_bottleneck(walls((4, 0)), (2, 4), (6, 4), 0.3) is None


def test_a_long_corridor_is_too_narrow_somewhere_along_it() -> None:
    region = shapely.union_all([box(0, 0, 4, 4), box(4, 1.7, 12, 2.3), box(12, 0, 16, 4)])
    found = find_bottleneck(polygonal(region), (2, 2), (14, 2), 0.5)
    assert found is not None
    assert 4 <= found.point[0] <= 12
    assert found.point[1] == pytest.approx(2, abs=0.01)
    assert found.width == pytest.approx(0.6, rel=0.01)


@given(
    st.floats(0.1, 0.9), st.floats(0.1, 0.9), st.floats(0, 360), st.floats(0.5, 8.5),
)  # fmt: skip
def test_width_and_place_of_two_doors(one: float, other: float, turn: float, y: float) -> None:
    region, ends = walls((y, one), (9 - y, other)), [(2.0, 4.5), (10.4, 4.5)]
    turned = affinity.rotate(region, turn, origin=(0, 0))
    start, goal = (_turned(end, turn) for end in ends)
    found = find_bottleneck(turned, start, goal, 0.5)
    assert found is not None
    assert found.width == pytest.approx(min(one, other), rel=0.015, abs=0.002)
    if abs(one - other) > 0.03:
        x, middle = (4.1, y) if one < other else (8.3, 9 - y)
        door = _turned((x, middle), turn)
        assert math.dist(found.point, door) <= 0.15 + min(one, other) / 2


def _turned(point: Point, degrees: float) -> Point:
    turned = affinity.rotate(shapely.Point(point), degrees, origin=(0, 0))
    return (turned.x, turned.y)


def test_the_place_named_is_in_the_region_and_as_wide() -> None:
    teeth = [Polygon([(x, 0), (x + 1, 1.3 + x / 100), (x + 2, 0)]) for x in np.arange(2, 14, 3)]
    region = polygonal(box(0, 0, 16, 2).difference(shapely.union_all(teeth)))
    found = find_bottleneck(region, (1, 1), (15.2, 1), 0.45)
    assert found is not None
    across = LineString([(found.point[0], -1), (found.point[0], 3)]).intersection(region)
    assert across.length == pytest.approx(found.width, rel=0.03)
    assert found.point[0] == pytest.approx(12, abs=0.1)
