"""Time routes on a Manhattan grid beside networkx and rustworkx, on the same graph.

The grid has N x N square zones of 1 m, with a door somewhere in each wall; one in five leads one
way only. The graph of all three has the passages for nodes, linked where one may follow another,
with the way between them in m for weight. rustworkx is no dependency (`make peers`). Lengths are
compared: who is fast and wrong does not count. Our own first answer is told apart, since it numbers
the graph.
"""

from __future__ import annotations

import importlib
import math
import statistics
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from random import Random
from typing import Any, TypeAlias

import networkx as nx
import numpy as np
import shapely

from benchmarks.peers import NOT_THERE, is_there
from benchmarks.table import Row, Table
from semtopo.atlas import Atlas
from semtopo.fusion import Extent
from semtopo.graph import Node, Passage, TopologyGraph
from semtopo.mapper import MapState
from semtopo.metric import MappedZone, MetricMap
from semtopo.route import Place, RouteRequest, find_routes
from semtopo.types import Point

SIDE = 100  # zones
QUERIES = 40
TWO_WAY = 0.8  # of the doors

Turns: TypeAlias = list[tuple[int, int, float]]
"""Passages by number, those that may follow them, and the way between in m."""


@dataclass(frozen=True)
class Grid:
    """A map, and the same as a graph of passages."""

    atlas: Atlas
    passages: list[Passage]
    turns: Turns

    def ends(self, start: Place, goal: Place) -> tuple[Turns, Turns]:
        """Return the ways from a start (-1) to passages, and from passages to a goal (-2)."""
        out = [
            (-1, number, math.dist(_point(start), it.point))
            for number, it in enumerate(self.passages)
            if it.source == start.zone_id
        ]
        into = [
            (number, -2, math.dist(it.point, _point(goal)))
            for number, it in enumerate(self.passages)
            if it.target == goal.zone_id
        ]
        return out, into


def make_grid(side: int, random: Random) -> Grid:
    """Return a Manhattan grid of `side` x `side` zones."""
    names = {(x, y): f"{x}-{y}" for x in range(side) for y in range(side)}
    passages: list[Passage] = []
    for (x, y), zone in names.items():
        for dx, dy in ((1, 0), (0, 1)):
            other = names.get((x + dx, y + dy))
            if other is not None:
                at = random.uniform(0.1, 0.9)
                point = (x + (dx or at), y + (dy or at))
                ways = [Passage(zone, other, point, 1), Passage(other, zone, point, 1)]
                passages += ways if random.random() < TWO_WAY else [random.choice(ways)]
    mapped = {
        name: MappedZone(name, name, Extent.of(shapely.box(x, y, x + 1, y + 1)), 1, 1)
        for (x, y), name in names.items()
    }
    nodes = {name: Node(name, name, 1) for name in mapped}
    graph = TopologyGraph(nodes, {passage.key: passage for passage in passages})
    atlas = Atlas(MapState(1, MetricMap(mapped), graph))
    return Grid(atlas, passages, _turns(passages))


def _turns(passages: list[Passage]) -> Turns:
    leaving: dict[str, list[int]] = {}
    for number, passage in enumerate(passages):
        leaving.setdefault(passage.source, []).append(number)
    return [
        (number, after, math.dist(passage.point, passages[after].point))
        for number, passage in enumerate(passages)
        for after in leaving.get(passage.target, ())
    ]


def _point(place: Place) -> Point:
    """Return the point of a place, which all places here have."""
    return place.point or (0.0, 0.0)


Asked: TypeAlias = tuple[Place, Place]

Answer: TypeAlias = Callable[[Asked], tuple[float, float]]
"""Gives the length of the shortest route, and the time that it took, both ends known, in s."""


def ours(grid: Grid) -> Answer:
    """Return what answers by semtopo."""

    def answer(asked: Asked) -> tuple[float, float]:
        began = time.perf_counter()
        request = RouteRequest(start=asked[0], goals=(asked[1],))
        length = find_routes(grid.atlas, request)[0].length
        return length, time.perf_counter() - began

    return answer


def by_networkx(grid: Grid) -> Answer:
    """Return what answers by networkx's bidirectional Dijkstra."""
    graph: nx.DiGraph[int] = nx.DiGraph()
    graph.add_weighted_edges_from(grid.turns)

    def answer(asked: Asked) -> tuple[float, float]:
        out, into = grid.ends(*asked)
        graph.add_weighted_edges_from(out + into)
        began = time.perf_counter()
        length = float(nx.bidirectional_dijkstra(graph, -1, -2)[0])
        seconds = time.perf_counter() - began
        graph.remove_nodes_from([-1, -2])
        return length, seconds

    return answer


def by_rustworkx(grid: Grid) -> Answer:
    """Return what answers by rustworkx's Dijkstra."""
    rustworkx: Any = importlib.import_module("rustworkx")
    graph = rustworkx.PyDiGraph(multigraph=False)
    graph.add_nodes_from(range(len(grid.passages)))
    graph.add_edges_from(grid.turns)

    def answer(asked: Asked) -> tuple[float, float]:
        out, into = grid.ends(*asked)
        start, goal = graph.add_node(None), graph.add_node(None)
        graph.add_edges_from([(start, it, way) for _, it, way in out])
        graph.add_edges_from([(it, goal, way) for it, _, way in into])
        began = time.perf_counter()
        lengths = rustworkx.dijkstra_shortest_path_lengths(graph, start, float, goal)
        seconds = time.perf_counter() - began
        graph.remove_nodes_from([start, goal])
        return float(lengths[goal]), seconds

    return answer


PEERS = {
    "networkx, bidirectional Dijkstra": ("networkx", by_networkx),
    "rustworkx, Dijkstra": ("rustworkx", by_rustworkx),
}
"""Name of a peer to its module, and what makes its answers."""


def timed(answer: Answer, asked: list[Asked]) -> tuple[list[float], list[float]]:
    """Return the lengths of routes, and the times they took in s."""
    lengths, times = zip(*map(answer, asked), strict=True)
    return list(lengths), list(times)


def tables() -> Iterator[Table]:
    """Yield the table of a grid."""
    random = Random(SIDE)
    grid = make_grid(SIDE, random)
    zones = list(grid.atlas.state.metric.zones)
    asked = []
    for _ in range(QUERIES):
        start, goal = random.sample(zones, 2)
        asked.append((Place(start, _middle(grid, start)), Place(goal, _middle(grid, goal))))
    first = ours(grid)
    _, cold = first(asked[0])
    _, cold_times = timed(first, asked)
    lengths, times = timed(first, asked)
    mine = statistics.median(times)
    rows = [
        row("semtopo, first of all", cold, mine),
        row("semtopo, new places", statistics.median(cold_times), mine),
        row("semtopo, warm", mine, mine),
    ]
    for name, (module, make) in PEERS.items():
        if not is_there(module):
            rows.append({"who": name, "median ms": NOT_THERE, "times ours": ""})
            continue
        theirs, their_times = timed(make(grid), asked)
        if not np.allclose(theirs, lengths):
            raise SystemExit(f"{name} finds other lengths")
        rows.append(row(name, statistics.median(their_times), mine))
    title = f"routes on {len(zones)} zones, {len(grid.passages)} passages: {QUERIES} pairs"
    yield title, rows


def row(name: str, seconds: float, mine: float) -> Row:
    """Return a row of the table."""
    return {"who": name, "median ms": f"{seconds * 1e3:.2f}", "times ours": f"{seconds / mine:.1f}"}


def _middle(grid: Grid, zone_id: str) -> Point:
    x, y = grid.atlas.state.metric.zones[zone_id].region.centroid.coords[0]
    return (x, y)
