"""Where a round robot may be: never too large, and too small by no more than told."""

from __future__ import annotations

import math
from random import Random

import pytest
import shapely
from shapely import MultiPolygon, Polygon, box

from benchmarks.dense_paths import field
from semtopo.geometry import Region, count_vertices, polygonal
from semtopo.inset import SKIN, SLACK, inset, sides
from tests.regions import DRAWS, Draw


def jagged(vertices: int) -> Polygon:
    """Return a round room whose wall is rough, with so many vertices."""
    random = Random(vertices)
    angles = [2 * math.pi * number / vertices for number in range(vertices)]
    radii = [5 + 0.02 * random.random() for _ in angles]
    return Polygon([(r * math.cos(a), r * math.sin(a)) for r, a in zip(radii, angles, strict=True)])


@pytest.mark.parametrize("draw", DRAWS, ids=lambda draw: draw.__name__)
@pytest.mark.parametrize("radius", [0.0, 0.05, 0.25])
def test_the_inset_keeps_its_distance_and_no_more(draw: Draw, radius: float) -> None:
    for seed in range(5):
        region = draw(Random(seed))
        space = inset(region, radius)
        assert space.is_valid
        if not space.is_empty:
            assert region.covers(space)
            assert space.distance(region.boundary) >= radius
        missing = region.buffer(-radius * (1 + SLACK) - 1e-6, quad_segs=64).difference(space)
        assert missing.area < 1e-9


def test_without_a_radius_corners_stay_sharp() -> None:
    space = inset(box(0, 0, 2, 1), 0)
    assert space.equals(box(SKIN, SKIN, 2 - SKIN, 1 - SKIN))


def test_a_corridor_as_wide_as_the_robot_is_none() -> None:
    assert inset(box(0, 0, 9, 1), 0.5).is_empty
    assert not inset(box(0, 0, 9, 1), 0.5 * (1 - SLACK)).is_empty


def test_what_touches_in_a_point_comes_apart() -> None:
    region = polygonal(box(0, 0, 4, 4).difference(Polygon([(2, 0), (3, 2), (2, 4), (1, 2)])))
    assert len(shapely.get_parts(inset(region, 0))) == 2


def test_a_crowded_wall_is_simplified() -> None:
    region = jagged(12_000)
    space = inset(region, 0.25)
    assert space.distance(region.boundary) >= 0.25
    assert shapely.get_num_coordinates(space) < 6_000
    tips = 5 - 0.25
    assert math.pi * (tips - SLACK * 0.25) ** 2 < space.area < math.pi * (tips + 0.02) ** 2


@pytest.mark.parametrize("vertices", [900, 1_500, 4_000])
def test_what_a_crowded_wall_loses_is_bounded(vertices: int) -> None:
    region, radius = jagged(vertices), 0.25
    space = inset(region, radius)
    assert space.distance(region.boundary) >= radius
    missing = region.buffer(-radius * (1 + SLACK), quad_segs=64).difference(space)
    assert missing.area < 1e-9


@pytest.mark.parametrize(
    ("region", "count"),
    [
        (box(0, 0, 1, 1), 4),
        (polygonal(box(0, 0, 3, 3).difference(box(1, 1, 2, 2))), 8),
        (MultiPolygon([box(0, 0, 1, 1), box(2, 0, 3, 1)]), 8),
    ],
)
def test_the_sides_of_a_region_are_its_border(region: Region, count: int) -> None:
    lines = sides(region)
    assert len(lines) == count
    assert shapely.union_all(lines).equals(region.boundary)


@pytest.mark.parametrize("vertices", [100, 250, 500, 900])
def test_arcs_have_fewer_chords_where_there_are_many(vertices: int) -> None:
    """A path through a field of stars is found among few thousand vertices, however many arcs."""
    region = field(vertices).region
    space = inset(region, 0.02)
    assert vertices < count_vertices(space) < 5 * 900
    missing = region.buffer(-0.02 * (1 + SLACK), quad_segs=64).difference(space)
    assert missing.area < 1e-9
