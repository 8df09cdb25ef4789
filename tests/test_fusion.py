"""Fusion by parts is the union, wherever the large region is cut."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from shapely import MultiPolygon, Polygon, box

from semtopo import fusion
from semtopo.fusion import box_around, fuse, within
from semtopo.geometry import Box, Region, polygonal
from tests.strategies import many, quick

SAME = 1e-9
MANY = 400
"""Vertices of a ring, so that three make a region that is cut."""


def star(seed: int, x: float, y: float, size: float, vertices: int = MANY) -> Polygon:
    """Return a jagged polygon around a point, as scans are."""
    chance = np.random.default_rng(seed)
    angle = np.linspace(0, 2 * np.pi, vertices, endpoint=False)
    radius = size * chance.uniform(0.6, 1, vertices)
    return Polygon(np.stack([x + radius * np.sin(angle), y + radius * np.cos(angle)], axis=-1))


@st.composite
def large_regions(draw: st.DrawFn) -> Region:
    """Draw a region of several jagged parts, some of which meet, with holes."""
    seeds = draw(st.lists(st.integers(0, 99), min_size=3, max_size=6, unique=True))
    parts = [star(seed, seed % 10, seed // 10, 1.5) for seed in seeds]
    holes = [star(seed, seed % 10 + 0.4, seed // 10, 0.3, 30) for seed in seeds]
    return polygonal(shapely.difference(shapely.union_all(parts), shapely.union_all(holes)))


@st.composite
def additions(draw: st.DrawFn) -> Polygon:
    """Draw a small jagged polygon, or a box with edges on round numbers."""
    x, y = draw(st.integers(0, 18)) / 2, draw(st.integers(0, 18)) / 2
    if draw(st.booleans()):
        return box(x, y, x + 1.5, y + 0.5)
    return star(draw(st.integers(100, 199)), x, y, 1.2, 60)


@quick
@given(region=large_regions(), addition=additions())
def test_fused_by_parts_is_the_union(region: Region, addition: Polygon) -> None:
    assert shapely.get_num_coordinates(region) > fusion.FEW_VERTICES
    fused = fuse(region, addition)
    assert fused.is_valid, shapely.is_valid_reason(fused)
    wanted = shapely.union(region, addition)
    assert fused.symmetric_difference(wanted).area < SAME
    assert shapely.get_num_geometries(fused) == shapely.get_num_geometries(wanted)
    apart = ~within(shapely.get_coordinates(region), box_around(addition))
    kept = {tuple(xy) for xy in shapely.get_coordinates(region)[apart].tolist()}
    assert kept <= {tuple(xy) for xy in shapely.get_coordinates(fused).tolist()}


def test_most_are_fused_by_parts(monkeypatch: pytest.MonkeyPatch) -> None:
    """The slow way is for the rare case; also, the drawn regions are cut in many ways."""
    counts = {"all": 0, "slow": 0, "parts": 0, "holes": 0, "pieces": 0}
    by_parts, outside = fusion._fused_within, fusion._outside

    def counting(region: Region, addition: Region, around: Box) -> Region:
        counts["all"] += 1
        try:
            return by_parts(region, addition, around)
        except (fusion._UnclearError, shapely.GEOSException):
            counts["slow"] += 1
            raise

    def counting_pieces(region: Region, around: Box) -> fusion._Pieces:
        found = outside(region, around)
        counts["pieces"] += len(found.cut) > 1
        return found

    monkeypatch.setattr(fusion, "_fused_within", counting)
    monkeypatch.setattr(fusion, "_outside", counting_pieces)

    @many
    @given(region=large_regions(), addition=additions())
    def count(region: Region, addition: Polygon) -> None:
        fused = fuse(region, addition)
        counts["parts"] += isinstance(fused, MultiPolygon)
        counts["holes"] += shapely.get_num_interior_rings(shapely.get_parts(fused)).sum() > 1

    count()
    assert counts["slow"] < 0.05 * counts["all"]
    for what in ("parts", "holes", "pieces"):
        assert counts[what] > 0.25 * counts["all"], what


def test_a_region_that_covers_the_addition_stays() -> None:
    region = star(1, 0, 0, 9.0, 900)
    assert fuse(region, box(-1, -1, 1, 1)) is region


def test_what_lies_apart_becomes_a_part() -> None:
    region = star(1, 0, 0, 1.0, 900)
    fused = fuse(region, box(5, 5, 6, 6))
    assert isinstance(fused, MultiPolygon)
    assert fused.area == pytest.approx(region.area + 1)


def test_an_addition_may_fill_a_hole_and_leave_an_island_in_one() -> None:
    ring = polygonal(shapely.difference(star(1, 0, 0, 9.0, 900), box(-3, -3, 3, 3)))
    filled = fuse(ring, box(-3.5, -3.5, 3.5, 3.5))
    assert isinstance(filled, Polygon)
    assert len(filled.interiors) == 0
    island = fuse(ring, box(-1, -1, 1, 1))
    assert shapely.get_num_geometries(island) == 2
    assert fuse(island, box(-0.5, 0, 0.5, 3.2)).is_valid


def test_a_border_along_the_cut_takes_the_slow_way() -> None:
    addition = box(0, 0, 1, 1)
    low_x, _, high_x, _ = box_around(addition)
    pillar = box(low_x, -6, high_x, 0.5)
    region = polygonal(shapely.union(star(1, 0.5, -5, 4.0, 900), pillar))
    fused = fuse(region, addition)
    assert fused.symmetric_difference(shapely.union(region, addition)).area < SAME
