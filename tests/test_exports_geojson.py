"""GeoJSON of what lies on the borders: all of them, once, with what is there."""

from __future__ import annotations

import json
from typing import Any

import pytest
import shapely
from hypothesis import given, settings
from shapely.geometry import shape

from semtopo.exports.geojson import borders_body
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


def test_a_border_without_claims_is_a_closed_frontier() -> None:
    from tests.test_borders import SQUARE, zone  # noqa: PLC0415

    state = MapState(metric=MetricMap({"a": zone(SQUARE, {})}))
    (only,) = features(borders_body(state))
    assert only["properties"] == {"zone_id": "a", "occupancy": "free"}
    line = shapely.LineString(only["geometry"]["coordinates"])
    assert line.is_ring
