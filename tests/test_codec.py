"""Maps as bytes: what is written reads back, and it is what its format promises."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import given

from semtopo.answers import answer
from semtopo.answers.values import PathAnswer
from semtopo.atlas import Atlas
from semtopo.codec import (
    answer_document,
    event_document,
    graph_body,
    route_document,
    step_document,
    to_json,
    zones_body,
)
from semtopo.errors import InvalidMapError
from semtopo.fusion import Extent
from semtopo.mapper import MapState, Step, explore
from semtopo.metric import MappedZone, MetricMap
from semtopo.readback import read_map
from semtopo.sensor import Sensor
from semtopo.types import MappingOptions
from semtopo.wkb import shape_bytes, shape_from
from tests.plans import LOOP, THREE_IN_A_ROW, drawn
from tests.strategies import Scene, options, patient, scenes


def explored(scene: Scene, chosen: MappingOptions) -> MapState:
    return list(explore(scene.world, scene.sensor, scene.walk, chosen))[-1].state


ROOM_SENSOR = Sensor(beams=36, range=3.0, samples=30)


@cache
def row_of_rooms() -> tuple[Step, ...]:
    """Return the steps of a walk through three rooms in a row."""
    walk = [(3.25, 2.5), (5.75, 2.5), (8.5, 2.5), (5.75, 2.5)]
    return tuple(explore(drawn(THREE_IN_A_ROW), ROOM_SENSOR, walk))


def bodies(state: MapState) -> tuple[bytes, bytes]:
    return zones_body(state), graph_body(state.graph, state.seq)


def zone(region: shapely.Polygon | shapely.MultiPolygon, zone_id: str = "a") -> MappedZone:
    return MappedZone(zone_id, zone_id, Extent.of(region), since=1, seq=2)


def feature(region: shapely.Polygon | shapely.MultiPolygon) -> dict[str, Any]:
    state = MapState(2, MetricMap({"a": zone(region)}))
    found: dict[str, Any] = json.loads(zones_body(state))["features"][0]
    return found


SQUARE = shapely.box(0, 0, 2, 2)
RING = SQUARE.difference(shapely.box(0.5, 0.5, 1.5, 1.5))
TWO = shapely.MultiPolygon([SQUARE, shapely.box(5, 5, 6, 6)])


@patient
@given(scene=scenes(), chosen=options)
def test_a_map_reads_back_to_itself(scene: Scene, chosen: MappingOptions) -> None:
    state = explored(scene, chosen)
    back = read_map(*bodies(state))
    assert bodies(back) == bodies(state)
    assert back.graph.nodes == dict(state.graph.nodes)
    assert back.graph.passages == dict(state.graph.passages)
    for zone_id, zone in state.metric.zones.items():
        assert back.metric.zones[zone_id].region.equals(zone.region)
        assert back.metric.zones[zone_id].region.area == pytest.approx(zone.region.area)


@patient
@given(scene=scenes(), chosen=options)
def test_stored_shapes_read_back_to_the_bit(scene: Scene, chosen: MappingOptions) -> None:
    for zone in explored(scene, chosen).metric.zones.values():
        stored, marks = shape_bytes(zone)
        ground, core = shape_from(stored, marks)
        assert core is None
        assert shape_bytes(replace(zone, extent=ground)) == (stored, marks)
        assert shapely.equals_identical(ground.region, zone.region)
        np.testing.assert_array_equal(ground.border.xy, zone.border.xy)
        np.testing.assert_array_equal(ground.border.begins, zone.border.begins)
        np.testing.assert_array_equal(ground.border.marks, zone.border.marks)


def test_an_empty_map() -> None:
    zones, graph = bodies(MapState())
    assert zones == b'{"type":"FeatureCollection","seq":0,"features":[]}'
    assert graph == b'{"seq":0,"nodes":[],"edges":[]}'
    assert bodies(read_map(zones, graph)) == (zones, graph)


@pytest.mark.parametrize(
    ("region", "kind", "rings"),
    [(SQUARE, "Polygon", 1), (SQUARE.reverse(), "Polygon", 1), (RING, "Polygon", 2),
     (TWO, "MultiPolygon", 2)],
    ids=["square", "clockwise square", "ring", "two squares"],
)  # fmt: skip
def test_zones_are_geojson(
    region: shapely.Polygon | shapely.MultiPolygon, kind: str, rings: int
) -> None:
    found = feature(region)
    assert (found["type"], found["id"]) == ("Feature", "a")
    assert found["properties"] == {"label": "a", "area": region.area, "since": 1, "seq": 2}
    assert found["geometry"]["type"] == kind
    polygons = found["geometry"]["coordinates"]
    polygons = [polygons] if kind == "Polygon" else polygons
    assert sum(map(len, polygons)) == rings
    for outer, *holes in polygons:
        for ring in (outer, *holes):
            assert ring[0] == ring[-1]
            assert len(ring) >= 4
        assert shapely.LinearRing(outer).is_ccw  # RFC 7946, 3.1.6
        assert not any(shapely.LinearRing(hole).is_ccw for hole in holes)


def test_zones_in_a_box() -> None:
    zones = {"a": zone(SQUARE), "b": zone(shapely.box(5, 5, 6, 6), "b")}
    state = MapState(2, MetricMap(zones))

    def found(*box: float) -> list[str]:
        left, low, right, high = box
        body = json.loads(zones_body(state, (left, low, right, high)))
        assert (body["type"], body["seq"]) == ("FeatureCollection", 2)
        return [one["id"] for one in body["features"]]

    assert found(-9, -9, 9, 9) == ["a", "b"]
    assert found(1, 1, 1, 1) == ["a"]
    assert found(2, 2, 3, 3) == ["a"]  # it touches
    assert found(2.1, 2.1, 3, 3) == []
    assert found(5.5, 0, 5.5, 9) == ["b"]


def test_the_graph_names_nodes_and_edges() -> None:
    state = row_of_rooms()[-1].state
    body = json.loads(graph_body(state.graph, state.seq))
    assert list(body) == ["seq", "nodes", "edges"]
    assert body["nodes"][0] == {"id": "a", "label": "a"}
    edges = {(edge["source"], edge["target"]) for edge in body["edges"]}
    assert edges == set(state.graph.pairs)
    assert all(
        1 <= edge["seq"] <= body["seq"] and len(edge["point"]) == 2 for edge in body["edges"]
    )


def test_steps_tell_what_they_found() -> None:
    first = row_of_rooms()[0]
    document = step_document(first)
    assert (document["seq"], document["here"]) == (1, "a")
    assert document["events"] == [event_document(event) for event in first.events]
    assert document["events"][0] == {"type": "node", "label": "a", "zone_id": "a"}
    edge = next(event for event in document["events"] if event["type"] == "edge")
    assert list(edge) == ["type", "source", "target", "point"]


def test_routes_and_answers() -> None:
    found = answer(Atlas(row_of_rooms()[-1].state), "path from a to b")
    assert isinstance(found, PathAnswer)
    document = json.loads(to_json(answer_document(found)))
    assert document["kind"] == "path"
    assert document["route"] == json.loads(to_json(route_document(found.route)))
    assert document["route"]["zones"] == ["a", "b"]
    assert len(document["route"]["passages"]) == 1


@pytest.mark.parametrize("number", [0.1, 1 / 3, 1e-300, 123456.789012345, -0.0, 5e-324, 1e6])
def test_numbers_read_back_to_the_bit(number: float) -> None:
    body = to_json({"number": number, "array": np.array([number])})
    back = json.loads(body)
    assert [np.float64(it).tobytes() for it in (back["number"], back["array"][0])] == [
        np.float64(number).tobytes()
    ] * 2


def changed(body: bytes, **values: object) -> bytes:
    return json.dumps({**json.loads(body), **values}).encode()


def bad_maps() -> list[Any]:
    zones, graph = bodies(list(explore(drawn(LOOP), ROOM_SENSOR, [(4.5, 4.5)]))[-1].state)
    features = json.loads(zones)["features"]
    line = {"type": "LineString", "coordinates": [[0, 0], [1, 1]]}
    edge = {"source": "a", "target": "nowhere", "point": [0, 0], "seq": 1}
    cases = {
        "no JSON": (b"zones", graph),
        "half": (zones[:-9], graph),
        "graph no JSON": (zones, b""),
        "a list": (b"[]", graph),
        "graph a list": (zones, b"[]"),
        "null": (b"null", b"null"),
        "no features": (b"{}", graph),
        "a feature that is none": (changed(zones, features=[1]), graph),
        "no geometry": (changed(zones, features=[features[0] | {"geometry": None}]), graph),
        "a line": (changed(zones, features=[features[0] | {"geometry": line}]), graph),
        "no properties": (changed(zones, features=[features[0] | {"properties": {}}]), graph),
        "no seq": (zones, json.dumps({"nodes": [], "edges": []}).encode()),
        "an edge to nowhere": (zones, changed(graph, edges=[edge])),
        "an edge without a point": (zones, changed(graph, edges=[edge | {"point": []}])),
        "other zones": (changed(zones, features=[]), graph),
        "other nodes": (zones, changed(graph, nodes=[])),
    }
    return [pytest.param(*bodies, id=name) for name, bodies in cases.items()]


@pytest.mark.parametrize(("zones", "graph"), bad_maps())
def test_what_is_no_map_is_refused(zones: bytes, graph: bytes) -> None:
    with pytest.raises(InvalidMapError):
        read_map(zones, graph)


def test_a_stored_region_must_be_one() -> None:
    with pytest.raises(InvalidMapError):
        shape_from(shapely.to_wkb(shapely.Point(0, 0)), b"")
