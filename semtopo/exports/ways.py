"""Ways inside the zones of a map, between their widest places and the gates to other zones.

In come a map and a robot's radius; out come polylines in m that keep to known free space. Between
two gates of a zone there is not always a way of their own: where one over others is hardly longer,
that will do (a greedy spanner), so that a long corridor has ways along it and not from each door to
every other.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TypeAlias

import networkx as nx
import shapely
from shapely import LineString
from shapely import Point as Dot
from shapely.geometry.base import BaseGeometry

from semtopo.errors.ways import NotConnectedError, OutsideError, TooNarrowError, UnprovedPathError
from semtopo.freespace import FreeSpace
from semtopo.geometry import Region, count_vertices, polygonal, widest_place
from semtopo.graph import Passage
from semtopo.ground import ground_of
from semtopo.mapper import MapState
from semtopo.metric import MetricMap
from semtopo.types import Point

STRETCH = 1.1
"""How much longer a way over others may be before two places get a way of their own."""

EASE = 0.02
"""m; by so much a way keeps off ragged borders, which then have few corners to go round."""

_BEYOND = 0.3  # m behind the middle of a doorway

NEIGHBOURS = 6
"""To how many gates a gate looks for ways, the nearest ones, and to its zone's widest place."""

WIDEST = -1
"""Stands for the widest place of a zone where gates have their numbers."""

Polyline: TypeAlias = tuple[Point, ...]


@dataclass(frozen=True, slots=True)
class Gate:
    """Where one goes from zone to zone, and the passages that go there, of both directions."""

    point: Point
    passages: tuple[Passage, ...]

    @property
    def ends(self) -> tuple[str, str]:
        """The two zones."""
        return (self.passages[0].source, self.passages[0].target)


@dataclass(frozen=True, slots=True)
class Way:
    """A way in a zone between two of its places: gates by number, or its `WIDEST` place."""

    ends: tuple[int, int]
    line: Polyline


def gates_of(state: MapState) -> list[Gate]:
    """Return the gates of a map in order of finding: the middles of doorways.

    Passages between zones without a doorway meet at their passage points.
    """
    found: dict[tuple[str, str, Point], list[Passage]] = {}
    for passage in state.graph.passages.values():
        one, other = sorted((passage.source, passage.target))
        point = _crossing(state.metric, passage)
        found.setdefault((one, other, point), []).append(passage)
    return [Gate(point, tuple(passages)) for (_, _, point), passages in found.items()]


def _crossing(metric: MetricMap, passage: Passage) -> Point:
    """Return the middle of the doorway nearest to a passage point, or that point if there is none.

    Doorways with equal distances are taken by number.
    """
    doorways = metric.doorways.between(passage.source, passage.target)
    if not doorways:
        return passage.point
    at = Dot(passage.point)
    nearest = min(doorways, key=lambda doorway: (doorway.region.distance(at), doorway.number))
    return widest_place(nearest.region)


@dataclass(frozen=True, slots=True)
class Yard:
    """A zone with its gates by their numbers, and the region in which its ways are."""

    zone_id: str
    place: Point
    gates: Mapping[int, Gate]
    region: Region

    @property
    def work(self) -> int:
        """About how much there is to do to find its ways."""
        return count_vertices(self.region) * (1 + len(self.gates))

    def ways(self, radius: float) -> list[Way]:
        """Return the ways between its widest place and its gates, by their numbers."""
        places = {WIDEST: self.place} | {it: gate.point for it, gate in self.gates.items()}
        space = FreeSpace(self.region, max(radius - EASE / 2, 0.0))
        found = [
            Way((one, other), line)
            for one, other in _candidates(places)
            if (line := _line(space, places[one], places[other])) is not None
        ]
        return list(_needed(found))


def yards_of(metric: MetricMap, gates: Sequence[Gate], radius: float) -> list[Yard]:
    """Return the yards of all zones, for a robot of a radius."""
    at: dict[str, dict[int, Gate]] = {zone_id: {} for zone_id in metric.zones}
    for number, gate in enumerate(gates):
        for end in gate.ends:
            at[end][number] = gate
    return [_yard(metric, zone_id, found, radius) for zone_id, found in at.items()]


def _yard(metric: MetricMap, zone_id: str, gates: Mapping[int, Gate], radius: float) -> Yard:
    """Return the yard of a zone: its ground, and at each gate what lies beyond it.

    In the middle of a doorway, the robot reaches into both zones. The region is a little smaller
    than that, and has far fewer corners.
    """
    ground = ground_of(metric, zone_id)
    regions: list[BaseGeometry] = [ground.region]
    for gate in gates.values():
        disc = Dot(gate.point).buffer(2 * radius + _BEYOND)
        regions += [metric.zones[end].region.intersection(disc) for end in gate.ends]
    inner = shapely.union_all(regions).buffer(-EASE, join_style="mitre").simplify(EASE / 2)
    return Yard(zone_id, ground.widest_place, gates, polygonal(inner))


def _candidates(
    places: dict[int, Point],
) -> Iterator[tuple[int, int]]:
    """Yield the pairs of places that a way may join."""
    gates = [number for number in places if number != WIDEST]
    pairs = {(WIDEST, gate): None for gate in gates}
    for gate in gates:
        others = sorted(gates, key=lambda it: (math.dist(places[it], places[gate]), it))
        for other in others[1 : NEIGHBOURS + 1]:
            pairs[min(gate, other), max(gate, other)] = None
    yield from pairs


def _line(space: FreeSpace, start: Point, end: Point) -> Polyline | None:
    """Return the shortest way from one point to another; `None` if there is none."""
    if start == end:
        return None
    if space.inset.covers(LineString([start, end])):
        return (start, end)
    try:
        bends = space.path(start, end).points[1:-1]
    except (NotConnectedError, OutsideError, TooNarrowError, UnprovedPathError):
        return None
    return (start, *bends, end)


def _needed(ways: Sequence[Way]) -> Iterator[Way]:
    """Yield the ways, shortest first, but for those that hardly save anything."""
    kept: nx.Graph[int] = nx.Graph()
    for length, _, way in sorted(
        (length_of(way.line), number, way) for number, way in enumerate(ways)
    ):
        one, other = way.ends
        if not _reaches(kept, one, other, STRETCH * length):
            kept.add_edge(one, other, weight=length)
            yield way


def _reaches(graph: nx.Graph[int], one: int, other: int, length: float) -> bool:
    """Say whether a way over others is no longer than a length."""
    if one not in graph or other not in graph:
        return False
    reached = nx.single_source_dijkstra_path_length(graph, one, cutoff=length)
    return other in reached


def length_of(line: Polyline) -> float:
    """Return the length of a polyline."""
    return sum(math.dist(*side) for side in pairwise(line))
