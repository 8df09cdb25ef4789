"""The metric map: it only grows, and what does not grow stays the same object."""

from __future__ import annotations

import pytest
import shapely
from hypothesis import given
from shapely import MultiPolygon, Polygon, box

from semtopo.fusion import Extent
from semtopo.geometry import Region
from semtopo.mapper import explore, scan_world, step
from semtopo.metric import MetricMap, here_first
from semtopo.placement import place
from semtopo.sensor_map import SensorMap
from semtopo.types import MappingOptions, Occupancy
from semtopo.zones import Zone
from tests.extents import all_around, claims_of
from tests.strategies import Scene, options, patient, scenes


def seen(here: str, **regions: Region) -> SensorMap:
    """Return a sensor map of some regions, seen from far away."""
    zones = tuple(Zone(label, Extent.of(region)) for label, region in sorted(regions.items()))
    return SensorMap((99.0, 99.0), zones, here, ())


def fused(metric: MetricMap, sensor_map: SensorMap, seq: int) -> MetricMap:
    """Return the map with a scan whose labels are zones."""
    return place(metric, sensor_map, MappingOptions(), seq).metric


def test_an_unknown_zone_is_new() -> None:
    zone = fused(MetricMap(), seen("a", a=box(0, 0, 1, 1)), 7).zones["a"]
    assert (zone.zone_id, zone.label, zone.since, zone.seq) == ("a", "a", 7, 7)
    assert zone.region.equals(box(0, 0, 1, 1))


def test_a_known_zone_grows() -> None:
    first = fused(MetricMap(), seen("a", a=box(0, 0, 1, 1)), 1)
    zone = fused(first, seen("a", a=box(1, 0, 2, 1)), 4).zones["a"]
    assert zone.region.equals(box(0, 0, 2, 1))
    assert (zone.since, zone.seq) == (1, 4)


def test_what_touches_nowhere_becomes_a_second_part() -> None:
    first = fused(MetricMap(), seen("a", a=box(0, 0, 1, 1)), 1)
    region = fused(first, seen("a", a=box(5, 0, 6, 1)), 2).zones["a"].region
    assert isinstance(region, MultiPolygon)
    assert region.area == 2


def test_an_older_map_stays_as_it_was() -> None:
    first = fused(MetricMap(), seen("a", a=box(0, 0, 1, 1)), 1)
    fused(first, seen("a", a=box(1, 0, 2, 1), b=box(3, 0, 4, 1)), 2)
    assert list(first.zones) == ["a"]
    assert first.zones["a"].region.area == 1


def test_zones_stand_in_the_order_of_finding_here_first() -> None:
    parts = {"a": box(0, 0, 1, 1), "b": box(1, 0, 2, 1), "c": box(2, 0, 3, 1)}
    assert [zone.label for zone in here_first(seen("b", **parts))] == ["b", "a", "c"]
    assert list(fused(MetricMap(), seen("b", **parts), 1).zones) == ["b", "a", "c"]


def test_changed_since_names_the_new_and_the_grown() -> None:
    old = fused(MetricMap(), seen("a", a=box(0, 0, 1, 1), b=box(5, 0, 6, 1)), 1)
    new = fused(old, seen("a", a=box(0, 0, 1, 1), b=box(5, 0, 7, 1), c=box(8, 0, 9, 1)), 2)
    assert [zone.label for zone in new.changed_since(old)] == ["b", "c"]
    assert new.changed_since(new) == []
    assert len(new.changed_since(MetricMap())) == 3


def test_border_points_that_fall_inside_are_dropped() -> None:
    first = Zone("a", all_around(box(0, 0, 1, 1), Occupancy.OBSTACLE))
    second = Zone("a", all_around(box(0.5, -1, 2, 2), Occupancy.FREE))
    known = fused(MetricMap(), SensorMap((0, 0), (first,), "a", ()), 1)
    border = fused(known, SensorMap((0, 0), (second,), "a", ()), 2).zones["a"].border
    assert claims_of(border) == {
        (0, 0): Occupancy.OBSTACLE, (0, 1): Occupancy.OBSTACLE,
        (0.5, -1): Occupancy.FREE, (0.5, 2): Occupancy.FREE,
        (2, -1): Occupancy.FREE, (2, 2): Occupancy.FREE,
    }  # fmt: skip


@patient
@given(scene=scenes(), chosen=options)
def test_the_map_only_grows(scene: Scene, chosen: MappingOptions) -> None:
    before = MetricMap()
    for number, taken in enumerate(explore(scene.world, scene.sensor, scene.walk, chosen), start=1):
        metric = taken.state.metric
        for zone in metric.zones.values():
            assert zone.region.is_valid
            assert zone.region.area > 0
            assert isinstance(zone.region, Polygon | MultiPolygon)
            assert zone.since <= zone.seq <= number
        for label, old in before.zones.items():
            assert old.region.difference(metric.zones[label].region).area < 1e-9
            assert metric.zones[label].since == old.since
        changed = {zone.label for zone in metric.changed_since(before)}
        assert changed == {label for label, zone in metric.zones.items() if zone.seq == number}
        before = metric


@patient
@given(scene=scenes())
def test_border_points_of_the_map_are_vertices(scene: Scene) -> None:
    *_, last = explore(scene.world, scene.sensor, scene.walk)
    for zone in last.state.metric.zones.values():
        parts = zone.region.geoms if isinstance(zone.region, MultiPolygon) else [zone.region]
        rings = [ring for part in parts for ring in (part.exterior, *part.interiors)]
        vertices = {vertex for ring in rings for vertex in ring.coords}
        assert {tuple(xy) for xy in zone.border.points()[0].tolist()} <= vertices
        assert zone.border.xy.tolist() == shapely.get_coordinates(zone.region).tolist()


@patient
@given(scene=scenes(), chosen=options)
def test_a_step_repeated_keeps_the_same_objects(scene: Scene, chosen: MappingOptions) -> None:
    *_, last = explore(scene.world, scene.sensor, scene.walk, chosen)
    scan = scan_world(scene.world, scene.sensor, scene.walk[-1])
    again = step(last.state, scan, chosen)
    assert again.events == ()
    assert again.here == last.here
    assert again.state.graph is last.state.graph
    assert again.state.seq == last.state.seq + 1
    assert again.state.metric.changed_since(last.state.metric) == []
    assert again.state.metric.zones.keys() == last.state.metric.zones.keys()


def test_maps_cannot_be_changed_from_outside() -> None:
    with pytest.raises(TypeError):
        MetricMap().zones["a"] = None  # type: ignore[index]


def test_maps_from_steps_cannot_be_changed_either() -> None:
    metric = fused(MetricMap(), seen("a", a=box(0, 0, 1, 1)), 1)
    with pytest.raises(TypeError):
        metric.zones["a"] = metric.zones["a"]  # type: ignore[index]
