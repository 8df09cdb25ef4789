"""Where the centre of a round robot may be: a region inset by the robot's radius.

The inset is never too large: each of its points is farther than the radius from the region's
border. It may be too small by a little, which `SLACK` bounds.
"""

from __future__ import annotations

import math
from typing import TypeAlias

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely import STRtree

from semtopo.geometry import Region, polygonal

Lines: TypeAlias = NDArray[np.object_]
"""An array (n,) of shapely LineStrings."""

SKIN = 1e-8
"""m; how much farther the inset stays from the border than asked. It keeps what touches in a point
from being passable, and is far above what rounding does to coordinates."""

SLACK = 0.05
"""The share of the radius by which the inset may be too small: chords in place of arcs (0.1 %), and
GEOS's own, which drops shallow concavities (1 %); where there are many vertices, coarser chords
(2 %) and simplification (2 %) too."""

_FINEST, _COARSEST = 16, 4
"""Chords in a quarter of a circle, for few and for many vertices; they run outside of it, so that
they keep the distance."""

_CHORDS = 4000
"""Chords in a quarter for all vertices together: an arc has a vertex for each, and of many vertices
there would be too many."""

_SIMPLER = 0.005
"""The share of the radius that a border of many vertices may lose to simplification, twice: before
the steps, and again after them."""

_MANY = 1000
"""Vertices that one step of the inset takes at once: the arcs of all corners within one step cross
each other, so of more vertices the dense ones are rounded off by short steps first."""


def inset(region: Region, radius: float) -> Region:
    """Return the places of a region farther than a radius (m, not negative) from its border.

    Empty if there are none.
    """
    shrunk = _shrunk(region, SKIN)
    if radius == 0 or shrunk.is_empty:
        return shrunk
    steps = _steps(shrunk, radius)
    crowded = len(steps) > 1
    for distance in steps:
        if crowded:
            shrunk = _simplified(shrunk, radius * _SIMPLER / len(steps))
        shrunk = rounded(shrunk, distance)
    if crowded:
        shrunk = _simplified(shrunk, radius * _SIMPLER)
    return _kept_off(shrunk, region, radius)


def rounded(region: Region, distance: float) -> Region:
    """Return a region inset by about a distance: GEOS may err by 1 % of it either way."""
    vertices = int(shapely.get_num_coordinates(region))
    quarter = min(max(_CHORDS // max(vertices, 1), _COARSEST), _FINEST)
    outside = distance / math.cos(math.pi / (4 * quarter))
    return polygonal(shapely.buffer(region, -outside, quad_segs=quarter))


def _steps(region: Region, radius: float) -> list[float]:
    """Split a radius into steps, each as long as all before it, the first ones short."""
    crowds = int(shapely.get_num_coordinates(region)) / _MANY
    halvings = math.ceil(math.log2(max(crowds, 1)))
    first = radius / 2**halvings
    return [first, *(first * 2**number for number in range(halvings))]


def _kept_off(region: Region, border: Region, radius: float) -> Region:
    """Shrink a region until it is farther than a radius from the border of another.

    GEOS simplifies a line before it offsets it, so a buffer may come too near by 1 % of its
    distance; each round leaves 1 % of what was missing.
    """
    walls, asked = STRtree(sides(border)), radius + SKIN / 2
    while not region.is_empty:
        lines = sides(region)
        near, far = walls.query(lines, predicate="dwithin", distance=asked)
        missing = asked - shapely.distance(lines[near], walls.geometries[far]).min(initial=asked)
        if missing <= 0:
            break
        region = _shrunk(region, float(missing) + SKIN)
    return region


def sides(region: Region) -> Lines:
    """Return the sides of a region's rings, as an array (n,) of LineStrings."""
    rings = shapely.get_rings(shapely.get_parts(region))
    points, ring = shapely.get_coordinates(rings, return_index=True)
    joined = ring[1:] == ring[:-1]
    ends = np.stack([points[:-1][joined], points[1:][joined]], axis=1)
    return np.asarray(shapely.linestrings(ends), dtype=np.object_)


def _simplified(region: Region, tolerance: float) -> Region:
    """Return a region with fewer vertices, within the first and at most 2 tolerances smaller."""
    return polygonal(shapely.simplify(_shrunk(region, tolerance), tolerance))


def _shrunk(region: Region, distance: float) -> Region:
    """Return a region inset by a small distance, its corners kept sharp."""
    return polygonal(shapely.buffer(region, -distance, join_style="mitre"))
