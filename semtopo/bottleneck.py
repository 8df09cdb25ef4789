"""The narrowest place of the widest way between two places of a region.

A robot too wide for every way wants to know where the best of them is too narrow, and by how much:
the radius is halved upon until the two places are just connected, and just not.
"""

from __future__ import annotations

from dataclasses import dataclass

import networkx as nx
import shapely
from shapely import STRtree

from semtopo.geometry import Polygons, Region
from semtopo.inset import SKIN, inset, rounded
from semtopo.types import Point

PRECISION = 1e-3
"""How exactly a width is found, as a share of the width that was needed."""

COARSENESS = 0.02
"""How far the border is simplified before, as a share of the radius: real borders are ragged, and
each halving takes as long as they have vertices."""

_GROWTH = 2.0
"""How far a place is grown back, in units of what it was shrunk by: enough to fill its corners, so
that what is left of the wider region are the necks between such places."""


_TRIES = 8
"""How often the shrinkage is doubled where GEOS's rounding hides a neck."""


@dataclass(frozen=True, slots=True)
class Bottleneck:
    """Where the widest way is narrowest (m, map frame), and how wide it is there (m)."""

    point: Point
    width: float


def find_bottleneck(region: Region, start: Point, goal: Point, radius: float) -> Bottleneck | None:
    """Return the narrowest place of the widest way; None if start and goal are not connected.

    Both have a clearance of at least `radius` (m, positive), for which there is no way. The width
    is found within some per cent, as the border is simplified; of several necks as narrow,
    the one nearest to the start along the way.
    """
    plain = inset(shapely.simplify(region, COARSENESS * radius), 0.0)
    wide, low, high = _part_of_both(plain, start, goal), 0.0, radius
    if wide is None:  # the connection may have been lost with the simplified border
        wide = _part_of_both(inset(region, 0.0), start, goal)
    if wide is None:
        return None
    whole = wide
    while high - low > PRECISION * radius:
        middle = (low + high) / 2
        part = _part_of_both(rounded(whole, middle), start, goal)
        wide, low, high = (wide, low, middle) if part is None else (part, middle, high)
    return Bottleneck(_neck(wide, high - low, start, goal), 2 * low)


def _part_of_both(space: Region, start: Point, goal: Point) -> Region | None:
    """Return the part of a space that holds both of two places, both in the space; None if none."""
    parts = shapely.get_parts(space)
    one, other = _part_at(parts, start), _part_at(parts, goal)
    return parts[one] if one == other else None


def _part_at(parts: Polygons, place: Point) -> int:
    """Return which part a place is in: the nearest, as rounding may put it just outside."""
    return int(shapely.distance(parts, shapely.Point(place)).argmin())


def _neck(wide: Region, shrinkage: float, start: Point, goal: Point) -> Point:
    """Return a place that connects start and goal in `wide`, and is lost when it is shrunk.

    A way that is everywhere as narrow may vanish as a whole: then any place on it will do.
    """
    for _ in range(_TRIES):
        halls = shapely.get_parts(rounded(wide, shrinkage))
        if len(halls) > 1 and _part_at(halls, start) != _part_at(halls, goal):
            return _between(wide, halls, shrinkage, (start, goal))
        shrinkage *= 2
    return _middle(wide)


def _between(wide: Region, halls: Polygons, shrinkage: float, ends: tuple[Point, Point]) -> Point:
    """Return a place between the hall of the start and the next on the way to the goal."""
    grown = shapely.buffer(halls, _GROWTH * shrinkage + SKIN, join_style="mitre")
    pieces = shapely.get_parts(shapely.difference(wide, shapely.union_all(grown)))
    graph = nx.Graph(_meetings(grown, pieces, shrinkage / 2))
    start, goal = (_part_at(halls, end) for end in ends)
    way = nx.shortest_path(graph, start, goal)
    piece = next((node for node in way if node >= len(halls)), None)
    if piece is None:
        line = shapely.shortest_line(halls[way[0]], halls[way[1]])
        return _xy(shapely.line_interpolate_point(line, 0.5, normalized=True))
    return _middle(pieces[piece - len(halls)])


def _meetings(grown: Polygons, pieces: Polygons, distance: float) -> list[tuple[int, int]]:
    """Return which of all polygons, numbered through, lie within a distance of each other."""
    polygons = [*grown, *pieces]
    one, other = STRtree(polygons).query(polygons, predicate="dwithin", distance=distance)
    return list(zip(one.tolist(), other.tolist(), strict=True))


def _middle(piece: Region) -> Point:
    """Return the centroid of a piece, or a place inside if that is outside."""
    centre = piece.centroid
    return _xy(centre if piece.intersects(centre) else piece.representative_point())


def _xy(point: shapely.Geometry) -> Point:
    """Return the coordinates of a point."""
    x, y = shapely.get_coordinates(point)[0]
    return (float(x), float(y))
