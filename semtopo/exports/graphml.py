"""The topology graph as GraphML: directed, with parallel edges, and attributes of both."""

from __future__ import annotations

import networkx as nx

from semtopo.exports.attributes import attributed_graph
from semtopo.exports.chart import Chart


def graphml_body(chart: Chart) -> bytes:
    """Return the graph as GraphML; nodes are named by zone id, edges numbered in order."""
    return "\n".join(nx.generate_graphml(attributed_graph(chart.state))).encode() + b"\n"
