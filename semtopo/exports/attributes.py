"""The topology graph as a graph of networkx, with all that is known of its nodes and edges."""

from __future__ import annotations

from typing import TypeAlias

import networkx as nx

from semtopo.graph import Passage
from semtopo.mapper import MapState
from semtopo.metric import MappedZone

Attributes: TypeAlias = dict[str, str | int | float]

Attributed: TypeAlias = "nx.MultiDiGraph[str]"


def attributed_graph(state: MapState) -> Attributed:
    """Return the graph by zone ids; the keys of its edges are the numbers of its passages.

    `x` and `y` in m, map frame, are those of the middle of a zone, and of a passage point.
    """
    graph: Attributed = nx.MultiDiGraph()
    for zone_id in state.graph.nodes:
        graph.add_node(zone_id, **zone_attributes(state.metric.zones[zone_id]))
    for edge in state.graph.passages.values():
        graph.add_edge(edge.source, edge.target, edge.number, **passage_attributes(edge))
    return graph


def zone_attributes(zone: MappedZone) -> Attributes:
    """Return what is known of a zone, but for its region."""
    x, y = zone.region.centroid.coords[0]
    return {
        "label": zone.label, "area": zone.region.area, "x": x, "y": y,
        "since": zone.since, "seq": zone.seq,
    }  # fmt: skip


def passage_attributes(passage: Passage) -> Attributes:
    """Return what is known of a passage, but for its ends."""
    x, y = passage.point
    return {"number": passage.number, "x": x, "y": y, "seq": passage.seq}
