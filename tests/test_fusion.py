"""Fusion is the union, whichever way it takes, and what is known of borders goes along."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from random import Random

import numpy as np
import pytest
import shapely
from hypothesis import given
from shapely import MultiPolygon, Polygon, box

from semtopo import fusion
from semtopo.border import arranged
from semtopo.course import UnclearError
from semtopo.formats import read_path, read_world
from semtopo.fusion import Extent, fuse
from semtopo.geometry import Region, polygonal
from semtopo.mapper import scan_world
from semtopo.sector import Sector
from semtopo.sensor import Sensor
from semtopo.sensor_map import extract
from semtopo.types import MappingOptions, Occupancy
from semtopo.zones import Zone
from tests.extents import all_around, claims_of
from tests.regions import grid, stars, tiles, turned_grid
from tests.strategies import Scene, many, quick, scenes

EXAMPLE = Path(__file__).parents[1] / "examples" / "paper"
SAME = 1e-9
UNIT = Extent.of(box(0, 0, 1, 1))
OPTIONS = MappingOptions()


def seen_of(scene: Scene) -> Iterator[Zone]:
    """Yield the zones of each scan of a scene."""
    for position in scene.walk:
        yield from extract(scan_world(scene.world, scene.sensor, position), OPTIONS).zones


def check(known: Extent, seen: Region, found: Extent) -> None:
    """Compare with the union of GEOS, and see that region and border are one."""
    assert found.region.is_valid, shapely.is_valid_reason(found.region)
    wanted = polygonal(shapely.union(known.region, seen))
    assert found.region.symmetric_difference(wanted).area < SAME
    assert len(shapely.get_rings(found.region)) == len(shapely.get_rings(wanted))
    np.testing.assert_array_equal(found.border.xy, shapely.get_coordinates(found.region))
    assert len(found.border.marks) == len(found.border.xy)
    assert found.border.begins[-1] == len(found.border.xy)
    assert found.border.areas().sum() == pytest.approx(found.region.area)


@quick
@given(scene=scenes())
def test_what_is_swept_is_the_union(scene: Scene) -> None:
    known: dict[str, Extent] = {}
    for zone in seen_of(scene):
        extent = known.get(zone.label, zone.extent)
        found = known[zone.label] = fuse(extent, zone.extent, zone.sectors)
        check(extent, zone.region, found)
        assert found is extent or found.region.area > extent.region.area


@pytest.mark.parametrize("beams", [12, 72, 360])
def test_the_run_of_the_paper_is_swept(beams: int) -> None:
    world = read_world((EXAMPLE / "world.json").read_bytes())
    path = [pose.position for pose in read_path((EXAMPLE / "path.csv").read_bytes())]
    known: dict[str, Extent] = {}
    for zone in seen_of(Scene(world, Sensor(beams, 2.0, 20), tuple(path))):
        extent = known.get(zone.label, zone.extent)
        known[zone.label] = fuse(extent, zone.extent, zone.sectors)
        check(extent, zone.region, known[zone.label])
    assert len(shapely.get_rings(known["corridor"].region)) > 1


def _parts(extent: Extent) -> int:
    return len(shapely.get_parts(extent.region))


SORTS = (
    "closed", "from robot", "beyond a door", "parts", "fewer parts", "nothing new",
)  # fmt: skip


def test_the_ways_of_fusion(monkeypatch: pytest.MonkeyPatch) -> None:
    """On lattices much is unclear; still, sectors of all sorts are swept."""
    counts: Counter[str] = Counter()
    swept = fusion._swept

    def counting(known: Extent, sector: Sector) -> Extent:
        counts["all"] += 1
        found = swept(known, sector)
        counts["swept"] += 1
        parts = _parts(found)
        counts["closed"] += sector.closed
        counts["from robot"] += sector.near is None and not sector.closed
        counts["beyond a door"] += sector.near is not None
        counts["parts"] += parts > 1
        counts["fewer parts"] += parts < _parts(known)
        counts["nothing new"] += found is known
        return found

    monkeypatch.setattr(fusion, "_swept", counting)

    @many
    @given(scene=scenes())
    def count(scene: Scene) -> None:
        known: dict[str, Extent] = {}
        for zone in seen_of(scene):
            extent = known.get(zone.label, zone.extent)
            known[zone.label] = fuse(extent, zone.extent, zone.sectors)

    count()
    assert counts["swept"] > 0.25 * counts["all"]
    for what in SORTS:
        assert counts[what] >= 5, counts


def test_a_robot_that_stands_still_changes_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    """Not even by way of GEOS: the border lies on the outline, and none of it inside."""
    monkeypatch.setattr(fusion, "_united", None)
    world = read_world((EXAMPLE / "world.json").read_bytes())
    for position in ((1.0, 6.0), (2.2, 6.03), (4.0, 7.0)):
        for zone in extract(scan_world(world, Sensor(72, 2.0, 20), position), OPTIONS).zones:
            assert fuse(zone.extent, zone.extent, zone.sectors) is zone.extent


def test_what_touches_in_places_takes_the_slow_way() -> None:
    world = read_world((EXAMPLE / "world.json").read_bytes())
    (zone, *_) = extract(scan_world(world, Sensor(72, 2.0, 20), (1.0, 6.0)), OPTIONS).zones
    (sector,) = zone.sectors
    x, y = sector.border.xy[3]
    touching = Extent.of(Polygon([(x, y), (x + 0.5, y + 3.0), (x - 0.5, y + 3.0)]))
    with pytest.raises(UnclearError):
        fusion._swept(touching, sector)
    check(touching, zone.region, fuse(touching, zone.extent, zone.sectors))


def test_fuse_is_the_union() -> None:
    fused = fuse(UNIT, Extent.of(box(0.5, 0, 1.5, 1)))
    assert fused.region.equals(box(0, 0, 1.5, 1))


def test_fuse_may_close_a_ring() -> None:
    ring = box(0, 0, 4, 4).difference(box(1, 1, 3, 3))
    left, right = (polygonal(ring.intersection(box(x, 0, x + 2, 4))) for x in (0, 2))
    fused = fuse(Extent.of(left), Extent.of(right)).region
    assert isinstance(fused, Polygon)
    assert len(fused.interiors) == 1


@pytest.mark.parametrize(
    "addition", [box(0, 0, 1, 1), box(0.2, 0.2, 0.8, 0.8), box(1, 0, 1 + 1e-12, 1)]
)
def test_fuse_without_gain_is_the_same_object(addition: Polygon) -> None:
    assert fuse(UNIT, Extent.of(addition)) is UNIT


def test_what_lies_apart_becomes_a_part() -> None:
    fused = fuse(UNIT, Extent.of(box(5, 5, 6, 6)))
    assert isinstance(fused.region, MultiPolygon)
    assert fused.region.area == pytest.approx(2)


def test_what_is_known_of_borders_is_traced() -> None:
    """Sides keep what they were, also those that are cut at one end or at both."""
    wall = all_around(box(0, 0, 4, 4), Occupancy.OBSTACLE)
    door = all_around(box(1, 3, 2, 5), Occupancy.PASSAGE)
    across = all_around(box(-1, 1, 5, 2), Occupancy.FREE)
    fused = fuse(fuse(wall, door), across)
    lengths = dict.fromkeys(Occupancy, 0.0)
    border = fused.border
    for one, other, side in zip(border.xy[:-1], border.xy[1:], border.sides[:-1], strict=True):
        lengths[Occupancy(int(side))] += float(np.abs(other - one).sum())
    assert lengths == pytest.approx({
        Occupancy.NONE: 0, Occupancy.FREE: 2 * 3,
        Occupancy.OBSTACLE: 4 + 3 + 2 + 4, Occupancy.PASSAGE: 1 + 1 + 1,
    })  # fmt: skip
    claims = claims_of(border)
    assert claims[0, 0] is Occupancy.OBSTACLE
    assert claims[2, 5] is Occupancy.PASSAGE
    assert (1, 4) not in claims
    assert (4, 1) not in claims


def test_of_two_claims_on_one_place_the_greater_holds() -> None:
    left, right = box(0, 0, 1, 1), box(1, 0, 2, 1)
    for one, other in ((Occupancy.FREE, Occupancy.OBSTACLE), (Occupancy.OBSTACLE, Occupancy.FREE)):
        claims = claims_of(fuse(all_around(left, one), all_around(right, other)).border)
        assert claims[0, 0] is one
        assert claims[2, 0] is other
        assert claims.get((1, 0), Occupancy.OBSTACLE) is Occupancy.OBSTACLE


def test_a_region_is_made_from_its_border() -> None:
    parts, holes = 0, 0
    for draw in (stars, grid, turned_grid, tiles):
        for seed in range(10):
            known = Extent.of(draw(Random(seed)))
            made = Extent(known.border).region
            assert made.wkb == known.region.wkb
            rings = Random(seed).sample(range(_rings(known)), _rings(known))
            shuffled = known.border.in_order(rings)
            assert shapely.normalize(Extent(arranged(shuffled)).region).equals(
                shapely.normalize(known.region)
            )
            parts += len(shapely.get_parts(made)) > 1
            holes += _rings(known) > len(shapely.get_parts(made))
    assert parts > 5
    assert holes > 5


def _rings(extent: Extent) -> int:
    return len(extent.border.begins) - 1
