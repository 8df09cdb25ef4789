"""Keep the few facts about polygons that several rooms need.

Regions are shapely Polygons or MultiPolygons, valid and not empty; x and y in metres, map frame.
"""

from __future__ import annotations

from typing import TypeAlias

import networkx as nx
import numpy as np
import shapely
from numpy.typing import NDArray
from shapely import MultiPolygon, Polygon
from shapely.geometry.base import BaseGeometry

from semtopo.types import Complexes, Floats, Point

Region: TypeAlias = Polygon | MultiPolygon
Polygons: TypeAlias = NDArray[np.object_]
"""An array (n,) of shapely Polygons."""

Box: TypeAlias = tuple[float, float, float, float]
"""Least x and y, greatest x and y, in m."""

NO_AREA = 1e-9
"""m^2; a square of 0.03 mm: what remains when a strip collapses to a line, not a place."""


TOUCH = 1e-9
"""m; places no further apart are one: far above what rounding does, far below any wall."""


GAP = 4e-7
"""m; so near to each other two regions meet: far below what a sensor can tell, and so small that a
mitre of it (5 times half of it, at most) stays within 1 um."""


def polygonal(geometry: BaseGeometry) -> Region:
    """Return the area of a geometry, without stray lines and points."""
    if isinstance(geometry, Polygon | MultiPolygon):
        return geometry
    parts = shapely.get_parts(geometry)
    return MultiPolygon([part for part in parts if isinstance(part, Polygon)])


def union(polygons: Polygons) -> Region:
    """Return the union of at least one polygon (R12)."""
    if len(polygons) == 1:
        return polygonal(polygons[0])
    return polygonal(shapely.union_all(polygons))


def joined(polygons: Polygons) -> Region:
    """Return the union of at least one polygon, gaps of less than GAP between them closed.

    What was computed to touch may miss by rounding. No border moves farther than 1 um, and what is
    wider apart stays apart.
    """
    grown = shapely.buffer(polygons, GAP / 2, join_style="mitre")
    largest = int(np.argmax(shapely.get_num_coordinates(grown)))
    whole = shapely.union(grown[largest], shapely.union_all(np.delete(grown, largest)))  # once
    return polygonal(shapely.buffer(whole, -GAP / 2, join_style="mitre"))


def groups_touching(probes: Polygons, others: Polygons | None = None) -> list[list[int]]:
    """Return the groups of regions that touch each other, directly or by way of others.

    Each group holds places, ascending: first those of the probes, then those of the others. Each
    holds a probe, and others only as far as probes touch them; groups are in order of their probes.
    """
    regions = probes if others is None else np.concatenate([probes, others])
    pairs = shapely.STRtree(regions).query(probes, predicate="dwithin", distance=TOUCH)
    found = nx.connected_components(nx.Graph(pairs.T.tolist()))
    return sorted(sorted(group) for group in found)


def apart(region: Region) -> list[Region]:
    """Return the places of a region that do not touch each other."""
    if isinstance(region, Polygon):
        return [region]
    parts = shapely.get_parts(region)
    return [union(parts[group]) for group in groups_touching(parts)]


def nearest_point(region: Region, position: Point) -> Point:
    """Return the point of a region nearest to a position, itself if it lies inside (R11).

    Of points at the same distance, the first along the region's rings.
    """
    line = shapely.shortest_line(region, shapely.Point(position))
    x, y = shapely.get_coordinates(line)[0]
    return (float(x), float(y))


def widest_place(region: Region) -> Point:
    """Return the place of a region that is farthest from its border, within 1 % of its extent.

    It is the centre of the largest circle inside (of any part), and always inside; however the
    rings are turned, it is the same.
    """
    circle = shapely.maximum_inscribed_circle(shapely.normalize(region))
    x, y = shapely.get_coordinates(circle)[0]
    return (float(x), float(y))


def count_vertices(region: Region) -> int:
    """Return how many vertices a region has; the first of a ring counts twice, as its last."""
    return int(shapely.get_num_coordinates(region))


def as_complex(points: Floats) -> Complexes:
    """Return (..., 2) points as a row of complex numbers: a point can be compared as one value."""
    return np.ascontiguousarray(points, dtype=np.float64).view(np.complex128).reshape(-1)
