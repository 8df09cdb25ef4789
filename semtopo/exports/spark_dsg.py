"""The zones as rooms of a scene graph, in the JSON of Spark-DSG (version 1.1).

Edges of a scene graph have no direction: each stands for all passages between two zones, and its
metadata lists them with theirs.
"""

from __future__ import annotations

import math

from semtopo.codec import Document, region_document, to_json
from semtopo.exports.chart import Chart
from semtopo.geometry import widest_place
from semtopo.graph import Passage
from semtopo.mapper import MapState
from semtopo.metric import MappedZone
from semtopo.types import Point

_VERSION = {"major": 1, "minor": 1, "patch": 3}
_LAYERS = {"OBJECTS": 2, "AGENTS": 2, "PLACES": 3, "ROOMS": 4, "BUILDINGS": 5}
_THICKNESS = 0.01  # m; a box without a height would count as no box
_ROOM = ord("R") << 56
"""A node's id is a letter in the highest of eight bytes, and a number."""


def spark_dsg_body(chart: Chart) -> bytes:
    """Return the map as a scene graph: its zones are rooms, named by zone id, their labels named.

    A room's metadata has its region as GeoJSON, since a scene graph has no room for that.
    """
    state = chart.state
    labels = list(dict.fromkeys(zone.label for zone in state.metric.zones.values()))
    places = {zone_id: widest_place(it.region) for zone_id, it in state.metric.zones.items()}
    ids = {zone_id: _ROOM + number for number, zone_id in enumerate(state.metric.zones)}
    document = {
        "SPARK_DSG_header": {"project_name": "main", "version": _VERSION},
        "directed": False,
        "multigraph": False,
        "layer_keys": [{"layer": layer, "partition": 0} for layer in sorted({*_LAYERS.values()})],
        "layer_names": {name: {"layer": it, "partition": 0} for name, it in _LAYERS.items()},
        "metadata": {"frame": "map", "seq": state.seq, "labelspaces": _labelspaces(labels)},
        "nodes": [
            _room(ids[zone_id], zone, places[zone_id], labels.index(zone.label))
            for zone_id, zone in state.metric.zones.items()
        ],
        "edges": [
            _edge(ids[one], ids[other], math.dist(places[one], places[other]), passages)
            for (one, other), passages in _by_pair(state).items()
        ],
    }
    return to_json(document)


def _labelspaces(labels: list[str]) -> Document:
    """Return the names of the semantic labels of layer 4, partition 0."""
    return {"_l4p0": [[number, label] for number, label in enumerate(labels)]}


def _by_pair(state: MapState) -> dict[tuple[str, str], list[Passage]]:
    """Return the passages between each two zones, both ways."""
    found: dict[tuple[str, str], list[Passage]] = {}
    for passage in state.graph.passages.values():
        one, other = sorted((passage.source, passage.target))
        found.setdefault((one, other), []).append(passage)
    return found


def _room(node: int, zone: MappedZone, place: Point, label: int) -> Document:
    left, low, right, high = zone.region.bounds
    attributes = {
        "type": "RoomNodeAttributes",
        "name": zone.zone_id,
        "position": [*place, 0.0],
        "semantic_label": label,
        "bounding_box": {
            "type": "AABB",
            "dimensions": [right - left, high - low, _THICKNESS],
            "world_P_center": [(left + right) / 2, (low + high) / 2, 0.0],
            "world_R_center": {"w": 1.0, "x": 0.0, "y": 0.0, "z": 0.0},
        },
        "metadata": {
            "label": zone.label, "area": zone.region.area, "since": zone.since, "seq": zone.seq,
            "region": region_document(zone.region),
        },
        "color": {"r": 0, "g": 0, "b": 0, "a": 255},
        "is_active": False,
        "is_predicted": False,
        "last_update_time_ns": 0,
        "semantic_class_probabilities": {},
        "semantic_feature": {"rows": 0, "cols": 0, "data": None},
    }  # fmt: skip
    return {"id": node, "layer": _LAYERS["ROOMS"], "partition": 0, "attributes": attributes}


def _edge(one: int, other: int, length: float, passages: list[Passage]) -> Document:
    told = [
        {"source": it.source, "target": it.target, "number": it.number,
         "point": it.point, "seq": it.seq}
        for it in passages
    ]  # fmt: skip
    info = {
        "type": "EdgeAttributes", "weighted": True, "weight": length,
        "metadata": {"passages": told},
    }  # fmt: skip
    return {"source": one, "target": other, "info": info}
