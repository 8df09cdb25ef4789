"""Where a way of bounded length can lead: an ellipse around its two ends.

Whoever goes from one focus of an ellipse to the other by a place outside goes farther than its long
axis. So of a large region, a small part is enough to find a way, and to know it is the shortest.
"""

from __future__ import annotations

import math

import numpy as np
import shapely
from shapely import Polygon

from semtopo.geometry import Polygons
from semtopo.types import Point

SIDES = 32
"""Of the polygon in place of an ellipse; it is up to 0.5 % wider."""

MARGIN = 1e-3
"""m; how much longer the axis is than asked, so that places within half of it of the ellipse are in
the polygon, too: far more than what joining regions or insetting them for no robot moves."""


def ellipse(one: Point, other: Point, length: float) -> Polygon:
    """Return a polygon around all ways of at most a length (m) between two points.

    The length is at least the distance of the points. Places within half the MARGIN of such ways
    lie inside as well.
    """
    apart, axis = math.dist(one, other), length + MARGIN
    outside = 1 / math.cos(math.pi / SIDES)
    half, breadth = axis / 2 * outside, math.sqrt(axis**2 - apart**2) / 2 * outside
    angles = np.arange(SIDES) * (2 * math.pi / SIDES)
    turn = complex(other[0] - one[0], other[1] - one[1]) / apart if apart else 1
    rim = (half * np.cos(angles) + 1j * breadth * np.sin(angles)) * turn
    rim += complex(one[0] + other[0], one[1] + other[1]) / 2
    return Polygon(np.stack([rim.real, rim.imag], axis=1))


def clipped(regions: Polygons, window: Polygon) -> Polygons:
    """Return what of some regions lies in a window, without those of which nothing does."""
    parts = shapely.intersection(regions, window)
    found: Polygons = parts[shapely.area(parts) > 0]
    return found
