"""Routes through the topology graph: which passages lead from one zone to another.

In come a graph and two zones; out goes the route with the fewest passages, and among those the one
whose passage points lie closest together. Edges are followed in their direction only.
"""

from __future__ import annotations

import math
from collections import defaultdict
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import networkx as nx

from semtopo.errors import NoRouteError, UnknownZoneError
from semtopo.graph import Passage, TopologyGraph


@dataclass(frozen=True, slots=True)
class Route:
    """The passages from zone `source` to zone `target`, in order; none if they are the same."""

    source: str
    target: str
    passages: tuple[Passage, ...]

    @property
    def zones(self) -> tuple[str, ...]:
        """The zones on the way, both ends included."""
        return (self.source, *(passage.target for passage in self.passages))

    @property
    def length(self) -> float:
        """The length in m of the line through the passage points; 0 below two passages."""
        return math.fsum(math.dist(a.point, b.point) for a, b in pairwise(self.passages))


def find_route(graph: TopologyGraph, source: str, target: str) -> Route:
    """Return the route with the fewest passages, then the shortest line through their points.

    Of routes that are alike in both, the one whose passages were found first.

    Raises
    ------
    UnknownZoneError
        One of the zones is not in the graph.
    NoRouteError
        No sequence of passages leads from the one to the other.
    """
    for zone_id in (source, target):
        if zone_id not in graph.nodes:
            raise UnknownZoneError("the map has no such zone")
    if source == target:
        return Route(source, target, ())
    try:
        start, *passages, end = nx.dijkstra_path(_choices(graph, source), source, target)
    except (nx.NetworkXNoPath, nx.NodeNotFound):
        raise NoRouteError("no passages lead from the one zone to the other") from None
    return Route(start, end, tuple(passages))


def _choices(graph: TopologyGraph, source: str) -> nx.DiGraph[Any]:
    """Return the passages that lead on without a detour, each linked to those that may follow.

    The weights are the distances between passage points in m. Every zone stands in it too, behind
    the passages that lead into it; the source stands before those that lead out of it.
    """
    zones: nx.DiGraph[str] = nx.DiGraph()
    zones.add_nodes_from(graph.nodes)
    zones.add_edges_from(graph.pairs)
    hops = nx.single_source_shortest_path_length(zones, source)
    leaving: defaultdict[str, list[Passage]] = defaultdict(list)
    for passage in graph.passages.values():
        if passage.source in hops and hops[passage.target] == hops[passage.source] + 1:
            leaving[passage.source].append(passage)
    choices: nx.DiGraph[Any] = nx.DiGraph()
    choices.add_edges_from(((source, passage) for passage in leaving[source]), weight=0.0)
    for passage in [passage for group in leaving.values() for passage in group]:
        choices.add_edge(passage, passage.target, weight=0.0)
        for following in leaving.get(passage.target, ()):
            distance = math.dist(passage.point, following.point)
            choices.add_edge(passage, following, weight=distance)
    return choices
