"""The topology graph M_s: which zones are linked, and where one passes (Alg. 3, V and E).

Edges are directed. A passage stays where it is (R10); only where zones or doorways prove to be one
do nodes and passages go, and then the graph still knows them as they were. How it grows is the
business of `findings`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TypeAlias, TypeVar, cast

from semtopo.types import Point

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
    passages between the same two zones apart: with all of them (R10) it is that of their doorway,
    else 0. `moved` is the step since which the passage has its key, if that came later.
    """

    source: str
    target: str
    point: Point
    seq: int
    number: int = 0
    moved: int = 0

    @property
    def key(self) -> PassageKey:
        """What names the passage in its graph."""
        return (self.source, self.target, self.number)


@dataclass(frozen=True, slots=True)
class Gone:
    """A node or a passage that is no more since step `until`; `rank` is its place among all.

    All are those that are and those that were, in order of finding.
    """

    was: Node | Passage
    rank: int
    until: int


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
    number: int = 0


@dataclass(frozen=True, slots=True)
class NodeMerged:
    """A zone proved to be part of another (R14): its passages are now those of zone `into`.

    Passages between the two are gone, and so are those that zone `into` had already.
    """

    zone_id: str
    into: str


@dataclass(frozen=True, slots=True)
class PassageJoined:
    """A passage proved to be the one with number `into` (R10), be it known already or not."""

    source: str
    target: str
    number: int
    into: int


Item = TypeVar("Item", Node, Passage)

Event: TypeAlias = NodeFound | PassageFound | NodeMerged | PassageJoined


@dataclass(frozen=True, slots=True, eq=False)
class TopologyGraph:
    """The graph M_s: nodes by zone id and passages by their keys, in order of finding.

    `gone` are the nodes and passages that were there at earlier steps.
    """

    nodes: Mapping[str, Node] = field(default_factory=dict)
    passages: Mapping[PassageKey, Passage] = field(default_factory=dict)
    gone: tuple[Gone, ...] = ()

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
        nodes = {
            node.zone_id: node
            for node, until in self.every_node()
            if node.seq <= seq and (until is None or seq < until)
        }
        passages = {
            edge.key: edge
            for edge, until in self.every_passage()
            if max(edge.seq, edge.moved) <= seq and (until is None or seq < until)
        }
        return TopologyGraph(nodes, passages, tuple(it for it in self.gone if it.until <= seq))

    def every_node(self) -> list[tuple[Node, int | None]]:
        """Return the nodes that are and were, in order of finding, and since when they are not."""
        return _every(self.nodes.values(), [it for it in self.gone if isinstance(it.was, Node)])

    def every_passage(self) -> list[tuple[Passage, int | None]]:
        """Return the passages that are and were, as `every_node` does."""
        gone = [it for it in self.gone if isinstance(it.was, Passage)]
        return _every(self.passages.values(), gone)


def _every(present: Iterable[Item], gone: Iterable[Gone]) -> list[tuple[Item, int | None]]:
    """Return what is and what was, in order of finding, and since when it is no more."""
    every: list[tuple[Item, int | None]] = [(item, None) for item in present]
    for former in sorted(gone, key=lambda it: it.rank):
        every.insert(former.rank, (cast(Item, former.was), former.until))
    return every
