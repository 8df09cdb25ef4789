"""The few facts about polygons, on specimens small enough to see."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

import numpy as np
import pytest
import shapely
from shapely import GeometryCollection, LineString, MultiPolygon, Polygon, box

from semtopo import geometry
from semtopo.types import Point

Join: TypeAlias = Callable[[geometry.Polygons], geometry.Region]

UNIT = box(0, 0, 1, 1)
FAR = box(5, 0, 6, 1)
RING = geometry.polygonal(box(0, 0, 4, 4).difference(box(1, 1, 3, 3)))


def polygons(*parts: geometry.Region) -> geometry.Polygons:
    return np.array(parts, dtype=np.object_)


@pytest.mark.parametrize("region", [UNIT, RING, MultiPolygon([UNIT, FAR])])
def test_polygonal_keeps_a_region(region: geometry.Region) -> None:
    assert geometry.polygonal(region) is region


def test_polygonal_drops_lines_and_points() -> None:
    mixed = GeometryCollection([UNIT, LineString([(0, 0), (9, 9)]), shapely.Point(7, 7), FAR])
    assert geometry.polygonal(mixed).equals(MultiPolygon([UNIT, FAR]))


def test_union_of_neighbours_is_one_polygon() -> None:
    joined = geometry.union(polygons(UNIT, box(1, 0, 2, 1)))
    assert joined.geom_type == "Polygon"
    assert joined.area == 2


def test_union_of_what_does_not_meet_has_two_parts() -> None:
    joined = geometry.union(polygons(UNIT, FAR))
    assert joined.geom_type == "MultiPolygon"
    assert joined.area == 2


def test_union_takes_overlaps() -> None:
    assert geometry.union(polygons(UNIT, box(0.5, 0, 1.5, 1))).area == 1.5


@pytest.mark.parametrize(
    ("region", "position", "wanted"),
    [
        (UNIT, (2, 0.5), (1, 0.5)),
        (UNIT, (2, 2), (1, 1)),
        (UNIT, (0.25, 0.5), (0.25, 0.5)),
        (RING, (2, 1.5), (2, 1)),
        (RING, (0.5, 0.5), (0.5, 0.5)),
        (MultiPolygon([UNIT, FAR]), (4, 0.5), (5, 0.5)),
    ],
)
def test_nearest_point(region: geometry.Region, position: Point, wanted: Point) -> None:
    assert geometry.nearest_point(region, position) == wanted


@pytest.mark.parametrize("gap", [0.0, 1e-9, 0.9 * geometry.GAP])
def test_joined_closes_gaps_that_rounding_left(gap: float) -> None:
    doorway = box(1 + gap, 0.2, 2, 0.8)
    region = geometry.joined(polygons(UNIT, doorway))
    assert isinstance(region, Polygon)
    assert region.area == pytest.approx(1.6, abs=1e-9)
    assert region.buffer(1e-12).covers(UNIT.union(doorway))


def test_joined_leaves_walls_where_they_are() -> None:
    apart = polygons(UNIT, box(1 + 1.1 * geometry.GAP, 0.2, 2, 0.8))
    assert isinstance(geometry.joined(apart), MultiPolygon)
    needle = Polygon([(0, 0), (3, 0), (0, 1e-5)])
    ring = polygons(RING, FAR, needle)
    assert shapely.hausdorff_distance(geometry.joined(ring), geometry.union(ring)) <= 1e-6


def test_the_widest_place_is_in_the_middle_of_the_widest_part() -> None:
    x, y = geometry.widest_place(MultiPolygon([UNIT, box(5, 0, 9, 4)]))
    assert (x, y) == pytest.approx((7, 2), abs=0.05)
    turned = shapely.orient_polygons(RING, exterior_cw=True)
    assert geometry.widest_place(turned) == geometry.widest_place(RING)
    x, y = geometry.widest_place(RING)
    assert RING.contains(shapely.Point(x, y))
    assert RING.boundary.distance(shapely.Point(x, y)) == pytest.approx(0.5858, rel=0.02)
