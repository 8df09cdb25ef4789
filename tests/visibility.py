"""The oracle of dense paths: the full visibility graph of a region, without a thought for speed."""

from __future__ import annotations

import math
from typing import TypeAlias

import networkx as nx
import numpy as np
import shapely

from semtopo.geometry import Region
from semtopo.types import Floats, Point

Graph: TypeAlias = "nx.Graph[Point]"


ROUNDING = 1e-9
"""m; how far a line may leave a region: ends on slanted sides are off them by rounding."""


def visibility_graph(region: Region) -> Graph:
    """Return the vertices of a region, linked where the line between them lies in it."""
    points = np.unique(shapely.get_coordinates(region), axis=0)
    one, other = np.triu_indices(len(points), 1)
    graph: Graph = nx.Graph()
    graph.add_nodes_from(map(tuple, points.tolist()))
    link(graph, region, points[one], points[other])
    return graph


def link(graph: Graph, region: Region, ones: Floats, others: Floats) -> None:
    """Link those of pairs of points (n, 2) that see each other in a region."""
    room = shapely.buffer(region, ROUNDING, join_style="mitre")
    shapely.prepare(room)
    seen = shapely.covers(room, shapely.linestrings(np.stack([ones, others], axis=1)))
    for a, b in zip(ones[seen].tolist(), others[seen].tolist(), strict=True):
        graph.add_edge(tuple(a), tuple(b), weight=math.dist(a, b))


def shortest_length(graph: Graph, region: Region, start: Point, goal: Point) -> float | None:
    """Return the length of the shortest path; None if there is none."""
    whole = graph.copy()
    vertices = np.array(list(graph.nodes))
    for point in (start, goal):
        whole.add_node(point)
        link(whole, region, np.broadcast_to(point, vertices.shape), vertices)
    link(whole, region, np.array([start]), np.array([goal]))
    try:
        return float(nx.dijkstra_path_length(whole, start, goal))
    except nx.NetworkXNoPath:
        return None
