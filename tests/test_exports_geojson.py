"""GeoJSON of what lies on the borders: all of them, once, with what is there."""

from __future__ import annotations

import json
from typing import Any

import pytest
import shapely
from hypothesis import event, given, settings
from hypothesis import strategies as st
from shapely.geometry import shape

from semtopo.exports.geojson import borders_body, doorways_body
from semtopo.mapper import MapState, explore
from semtopo.metric import MetricMap
from tests.strategies import Scene, scenes


def features(body: bytes) -> list[dict[str, Any]]:
    collection = json.loads(body)
    assert collection["type"] == "FeatureCollection"
    found: list[dict[str, Any]] = collection["features"]
    return found


def test_an_empty_map_has_no_borders() -> None:
    assert json.loads(borders_body(MapState(seq=3))) == {
        "type": "FeatureCollection", "seq": 3, "features": [],
    }  # fmt: skip


@settings(max_examples=30)
@given(scene=scenes())
def test_the_lines_of_a_zone_are_its_border(scene: Scene) -> None:
    *_, last = explore(scene.world, scene.sensor, scene.walk)
    zones = last.state.metric.zones
    lines = features(borders_body(last.state))
    for zone_id, zone in zones.items():
        mine = [shape(it["geometry"]) for it in lines if it["properties"]["zone_id"] == zone_id]
        assert all(zone.region.boundary.dwithin(line, 1e-9) for line in mine)
        assert sum(line.length for line in mine) == pytest.approx(zone.region.length)
    assert {it["properties"]["zone_id"] for it in lines} == set(zones)
    assert {it["properties"]["occupancy"] for it in lines} <= {"obstacle", "passage", "free"}


@settings(max_examples=30)
@given(scene=scenes(), corners=st.tuples(*[st.floats(-2, 14) for _ in range(4)]))
def test_in_a_box_is_what_meets_it(scene: Scene, corners: tuple[float, ...]) -> None:
    *_, last = explore(scene.world, scene.sensor, scene.walk)
    (left, right), (low, high) = sorted(corners[:2]), sorted(corners[2:])
    box = (left, low, right, high)
    zones, doorways = last.state.metric.zones, last.state.metric.doorways
    near = {zone_id for zone_id, zone in zones.items() if shapely.box(*box).intersects(zone.region)}
    event(f"all of {len(zones)}" if near == set(zones) else f"{len(near)} of {len(zones)}")
    everything = features(borders_body(last.state))
    chosen = [it for it in everything if it["properties"]["zone_id"] in near]
    assert features(borders_body(last.state, box)) == chosen
    everything = features(doorways_body(last.state))
    assert len(everything) == len(doorways)
    chosen = [it for it in everything if shape(it["geometry"]).intersects(shapely.box(*box))]
    assert features(doorways_body(last.state, box)) == chosen


@settings(max_examples=30)
@given(scene=scenes(), tolerance=st.floats(0.01, 1e6))
def test_lines_stay_within_the_tolerance(scene: Scene, tolerance: float) -> None:
    *_, last = explore(scene.world, scene.sensor, scene.walk)
    for body in (borders_body, doorways_body):
        whole, reduced = features(body(last.state)), features(body(last.state, None, tolerance))
        assert [it["properties"] for it in whole] == [it["properties"] for it in reduced]
        for one, other in zip(whole, reduced, strict=True):
            real, coarse = shape(one["geometry"]), shape(other["geometry"])
            assert coarse.is_valid
            assert not coarse.is_empty
            lines = (coarse, real) if coarse.geom_type == "LineString" else (
                coarse.boundary, real.boundary,
            )  # fmt: skip
            assert shapely.hausdorff_distance(*lines) <= tolerance + 1e-9
            assert len(shapely.get_coordinates(coarse)) <= len(shapely.get_coordinates(real))
    event("fewer" if len(body(last.state, None, tolerance)) < len(body(last.state)) else "all")


def test_a_border_without_claims_is_a_closed_frontier() -> None:
    from tests.test_borders import SQUARE, zone  # noqa: PLC0415

    state = MapState(metric=MetricMap({"a": zone(SQUARE, {})}))
    (only,) = features(borders_body(state))
    assert only["properties"] == {"zone_id": "a", "occupancy": "free"}
    line = shapely.LineString(only["geometry"]["coordinates"])
    assert line.is_ring
