"""The oracle of dense paths: the full visibility graph of a region, without a thought for speed."""

from __future__ import annotations

import math
from typing import TypeAlias

import networkx as nx
import numpy as np
import shapely

from semtopo.geometry import Region
from semtopo.types import Flags, Floats, Integers, Point

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
    seen = sights(region, ones, others)
    for a, b in zip(ones[seen].tolist(), others[seen].tolist(), strict=True):
        graph.add_edge(tuple(a), tuple(b), weight=math.dist(a, b))


def sights(region: Region, ones: Floats, others: Floats) -> Flags:
    """Say which of pairs of points (n, 2) see each other in a region."""
    room = shapely.buffer(region, ROUNDING, join_style="mitre")
    shapely.prepare(room)
    seen: Flags = np.asarray(
        shapely.covers(room, shapely.linestrings(np.stack([ones, others], axis=1)))
    )
    return seen


class ShortestWays:
    """The lengths of the shortest ways in a region, by its visibility graph."""

    def __init__(self, region: Region) -> None:
        """Find the shortest way from each vertex to each other (Floyd and Warshall)."""
        self._region = region
        self._vertices = points = np.unique(shapely.get_coordinates(region), axis=0)
        count = len(points)
        one, other = np.triu_indices(count, 1)
        seen = sights(region, points[one], points[other])
        one, other = one[seen], other[seen]
        self._between = ways = np.full((count, count), np.inf)
        ways[one, other] = ways[other, one] = np.hypot(*(points[one] - points[other]).T)
        np.fill_diagonal(ways, 0)
        for by in range(count):
            np.minimum(ways, ways[:, by, None] + ways[by], out=ways)

    def length(self, start: Point, goal: Point) -> float | None:
        """Return the length of the shortest way; None if there is none."""
        if sights(self._region, np.array([start]), np.array([goal]))[0]:
            return math.dist(start, goal)
        (begin, begun), (end, ended) = self._seen_from(start), self._seen_from(goal)
        ways = begun[:, None] + self._between[np.ix_(begin, end)] + ended
        least = float(np.min(ways, initial=math.inf))
        return None if math.isinf(least) else least

    def _seen_from(self, point: Point) -> tuple[Integers, Floats]:
        """Return the numbers of the vertices that are seen from a point, and how far they are."""
        from_here = np.broadcast_to(point, self._vertices.shape)
        (seen,) = np.nonzero(sights(self._region, from_here, self._vertices))
        return seen, np.hypot(*(self._vertices[seen] - point).T)
