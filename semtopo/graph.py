"""The topology graph M_s: which zones are linked, and where one passes (Alg. 3, V and E).

In come the zones and links of one scan; out goes a new graph and what is new in it. Edges are
directed; they are never moved and never removed (R10).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TypeAlias

from semtopo.metric import here_first
from semtopo.types import Point
from semtopo.zones import Link, SensorMap

PassageKey: TypeAlias = tuple[str, str, int]
"""Zone ids of source and target, and which of the passages between them, from 0."""


@dataclass(frozen=True, slots=True)
class Node:
    """A vertex V(s): a zone of the metric map, with its class and the step that found it."""

    zone_id: str
    label: str
    seq: int


@dataclass(frozen=True, slots=True)
class Passage:
    """A directed edge E(s_r, s_u, p_u): from zone `source` to zone `target` at `point`.

    The point is in m, map frame; `seq` is the step that found the edge. `number` tells parallel
    passages between the same two zones apart, from 0.
    """

    source: str
    target: str
    point: Point
    seq: int
    number: int = 0

    @property
    def key(self) -> PassageKey:
        """What names the passage in its graph."""
        return (self.source, self.target, self.number)


@dataclass(frozen=True, slots=True)
class NodeFound:
    """A step found a zone."""

    label: str
    zone_id: str


@dataclass(frozen=True, slots=True)
class PassageFound:
    """A step found a passage."""

    source: str
    target: str
    point: Point


Event: TypeAlias = NodeFound | PassageFound


@dataclass(frozen=True, slots=True, eq=False)
class TopologyGraph:
    """The graph M_s: nodes by zone id and passages by their keys, in order of finding."""

    nodes: Mapping[str, Node] = field(default_factory=dict)
    passages: Mapping[PassageKey, Passage] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Let nobody change nodes and passages from here on."""
        object.__setattr__(self, "nodes", MappingProxyType(self.nodes))
        object.__setattr__(self, "passages", MappingProxyType(self.passages))

    @property
    def pairs(self) -> tuple[tuple[str, str], ...]:
        """Source and target of every passage, in order of finding."""
        return tuple((source, target) for source, target, _ in self.passages)

    def at(self, seq: int) -> TopologyGraph:
        """Return the graph as it was after step `seq`."""
        nodes = {key: node for key, node in self.nodes.items() if node.seq <= seq}
        passages = {key: edge for key, edge in self.passages.items() if edge.seq <= seq}
        return TopologyGraph(nodes, passages)

    def extended(self, sensor_map: SensorMap, seq: int) -> tuple[TopologyGraph, tuple[Event, ...]]:
        """Return the graph with the findings of one scan, and the events in Algorithm 3's order.

        A passage is new only if its pair of zones had none (R10).
        """
        nodes, passages = dict(self.nodes), dict(self.passages)
        events: list[Event] = []
        for label, links in _in_order(sensor_map):
            if label not in nodes:  # Alg. 3, l. 10 and 26
                nodes[label] = Node(label, label, seq)
                events.append(NodeFound(label, label))
            for link in links:
                pair = (link.source, link.target)
                if (*pair, 0) not in passages:  # Alg. 3, l. 19-22 and 27
                    point = link.nearest_point(sensor_map.position)
                    found = Passage(*pair, point, seq)
                    passages[found.key] = found
                    events.append(PassageFound(*pair, point))
        if not events:
            return self, ()
        return TopologyGraph(nodes, passages), tuple(events)


def _in_order(sensor_map: SensorMap) -> Iterator[tuple[str, list[Link]]]:
    """Yield each label with the links that are complete once it is known (Alg. 3, l. 13-29)."""
    labels = [zone.label for zone in here_first(sensor_map)]
    rank = {label: number for number, label in enumerate(labels)}
    completed: dict[str, list[Link]] = {label: [] for label in labels}
    for link in sensor_map.links:
        completed[max(link.source, link.target, key=rank.__getitem__)].append(link)
    yield from completed.items()
