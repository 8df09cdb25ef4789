"""A graph to drive along, for the route server of Nav2: points and straight edges, as GeoJSON.

Its nodes are the widest place of each zone, the middle of each doorway that a passage uses, and
the bends of the ways between them; so a robot that goes straight from node to node stays in known
free space, with its radius from what is not. Edges are directed: one leaves a zone through a
doorway only where the graph has a passage.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

from semtopo.codec import Document, to_json
from semtopo.errors import NotExportableError
from semtopo.exports.chart import Chart
from semtopo.exports.ways import WIDEST, Polyline, gates_of, yards_of
from semtopo.graph import PassageKey
from semtopo.mapper import MapState
from semtopo.types import Point

IDS_MAX = 65_535
"""Nodes and edges together: the server numbers both with 16 bits."""

PASSAGES_MAX = 10_000
"""Of a map: the ways between so many take some seconds to find."""


def nav2_body(chart: Chart) -> bytes:
    """Return the graph to drive along; ids count from 0, first those of nodes, then of edges.

    `left_out` names the passages of which no way is known: no doorway was seen, or it is too
    narrow for the robot.

    Raises
    ------
    NotExportableError
        There would be more than `IDS_MAX` nodes and edges, or no edge at all, which the server
        does not take; there are more than `PASSAGES_MAX` passages; or it is too much work.
    """
    passages = chart.state.graph.passages
    if len(passages) > PASSAGES_MAX:
        raise NotExportableError(f"a graph to drive along has at most {PASSAGES_MAX} passages")
    network = _Network(chart.state)
    network.join(chart.radius, chart.work_max)
    if not network.edges or len(network.nodes) + len(network.edges) > IDS_MAX:
        many = f"{len(network.nodes)} nodes and {len(network.edges)} edges"
        raise NotExportableError(f"{many}: the server takes some edges, and {IDS_MAX} ids in all")
    document = {
        "type": "FeatureCollection", "name": "semtopo", "seq": chart.state.seq,
        "left_out": [key for key in passages if key not in network.joined],
        "features": [*network.node_features(), *network.edge_features()],
    }  # fmt: skip
    return to_json(document)


@dataclass(frozen=True, slots=True)
class _Node:
    """A node by what it is: the place of a zone, a gate by its number, a bend in a zone."""

    kind: str
    zone_id: str | None
    gate: int | None
    point: Point


class _Network:
    """Nodes and edges in order of finding, by what tells them apart."""

    def __init__(self, state: MapState) -> None:
        self._state = state
        self._gates = gates_of(state)
        self._entered: set[tuple[str, int]] = set()
        self._left: set[tuple[str, int]] = set()
        self.joined: set[PassageKey] = set()
        self.nodes: dict[_Node, int] = {}
        self.edges: dict[tuple[int, int], str] = {}

    def join(self, radius: float, work_max: int | None) -> None:
        """Find the ways in all zones, and take those that passages allow."""
        yards = yards_of(self._state.metric, self._gates, radius)
        if work_max is not None and sum(yard.work for yard in yards) > work_max:
            raise NotExportableError("the ways of so large a map take too long to find")
        ways = {yard.zone_id: yard.ways(radius) for yard in yards}
        self._allow({(it, end) for it, found in ways.items() for way in found for end in way.ends})
        for zone_id, found in ways.items():
            for way in found:
                self._take(zone_id, *way.ends, way.line)
                self._take(zone_id, *way.ends[::-1], way.line[::-1])

    def _allow(self, reached: set[tuple[str, int]]) -> None:
        """Allow to go through the gates by the passages whose both sides are reached."""
        for number, gate in enumerate(self._gates):
            for passage in gate.passages:
                if {(passage.source, number), (passage.target, number)} <= reached:
                    self.joined.add(passage.key)
                    self._left.add((passage.source, number))
                    self._entered.add((passage.target, number))

    def _take(self, zone_id: str, one: int, other: int, line: Polyline) -> None:
        """Take a way in a zone, from one place to another, if both ends may be used so."""
        may_begin = one == WIDEST or (zone_id, one) in self._entered
        may_end = other == WIDEST or (zone_id, other) in self._left
        if not (may_begin and may_end):
            return
        bends = [_Node("bend", zone_id, None, point) for point in line[1:-1]]
        nodes = [_end(zone_id, one, line[0]), *bends, _end(zone_id, other, line[-1])]
        numbers = [self.nodes.setdefault(node, len(self.nodes)) for node in nodes]
        for pair in pairwise(numbers):
            self.edges.setdefault(pair, zone_id)

    def node_features(self) -> Iterator[Document]:
        """Yield the nodes as points; `class` is the label of a zone."""
        for node, number in self.nodes.items():
            metadata: Document = {"kind": node.kind}
            if node.zone_id is not None:
                metadata |= self._about(node.zone_id)
            if node.gate is not None:
                metadata["zones"] = sorted(self._gates[node.gate].ends)
            geometry = {"type": "Point", "coordinates": node.point}
            yield _feature(geometry, {"id": number, "frame": "map", "metadata": metadata})

    def edge_features(self) -> Iterator[Document]:
        """Yield the edges as straight lines; `cost` is their length in m."""
        points = [node.point for node in self.nodes]
        for number, ((one, other), zone_id) in enumerate(self.edges.items(), start=len(points)):
            line = (points[one], points[other])
            properties = {
                "id": number, "startid": one, "endid": other, "cost": math.dist(*line),
                "overridable": True, "metadata": self._about(zone_id),
            }  # fmt: skip
            yield _feature({"type": "LineString", "coordinates": line}, properties)

    def _about(self, zone_id: str) -> Document:
        return {"zone": zone_id, "class": self._state.metric.zones[zone_id].label}


def _end(zone_id: str, gate: int, point: Point) -> _Node:
    """Return the node at an end of a way: a gate, which two zones share, or a zone's place."""
    if gate == WIDEST:
        return _Node("place", zone_id, None, point)
    return _Node("doorway", None, gate, point)


def _feature(geometry: Document, properties: Document) -> Document:
    return {"type": "Feature", "geometry": geometry, "properties": properties}
