"""Maps read back from the bodies that `codec` writes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import orjson
import shapely

from semtopo.errors import InvalidMapError
from semtopo.fusion import Extent
from semtopo.geometry import Region
from semtopo.graph import Node, Passage, TopologyGraph
from semtopo.mapper import MapState
from semtopo.metric import MappedZone, MetricMap


def read_map(zones: bytes, graph: bytes) -> MapState:
    """Read a map back from its two bodies.

    What is known of borders is no part of the bodies: nothing is in the result.

    Raises
    ------
    InvalidMapError
        The bodies are none that this module wrote.
    """
    try:
        return _map_from(orjson.loads(zones), orjson.loads(graph))
    except (LookupError, TypeError, ValueError, shapely.errors.ShapelyError) as error:
        raise InvalidMapError("these are not the zones and the graph of a map") from error


def _map_from(zones: Mapping[str, Any], graph: Mapping[str, Any]) -> MapState:
    """Return the map of two parsed bodies."""
    mapped = {feature["id"]: _zone_from(feature) for feature in zones["features"]}
    nodes = {node["id"]: _node_from(node, mapped) for node in graph["nodes"]}
    edges = [
        Passage(
            edge["source"], edge["target"], (edge["point"][0], edge["point"][1]), edge["seq"],
            edge.get("n", 0),
        )
        for edge in graph["edges"]
    ]  # fmt: skip
    passages = {edge.key: edge for edge in edges}
    ends = {end for edge in edges for end in (edge.source, edge.target)}
    if ends - set(nodes) or set(mapped) != set(nodes):
        raise InvalidMapError("zones and graph do not belong together")
    return MapState(graph["seq"], MetricMap(mapped), TopologyGraph(nodes, passages))


def _node_from(node: Mapping[str, Any], mapped: Mapping[str, MappedZone]) -> Node:
    return Node(node["id"], node["label"], mapped[node["id"]].since)


def _zone_from(feature: Mapping[str, Any]) -> MappedZone:
    region = shapely.from_geojson(orjson.dumps(feature["geometry"]))
    if not isinstance(region, Region):
        raise InvalidMapError("a zone is no polygon")
    about = feature["properties"]
    extent = Extent.of(region)
    return MappedZone(feature["id"], about["label"], extent, about["since"], about["seq"])
