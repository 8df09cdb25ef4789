"""A part of a world laid out as a table, so that reading a place costs the same in any world.

In come the rectangles that meet a square; out goes what is on top at each of many places in it.
Rectangles are closed, and the later one wins (R4), also at a place that lies exactly on an edge.

The edges of the rectangles cut each axis into points and the gaps between them; one table entry for
each pair says what is there. Which point or gap a coordinate lies in is known at once for most: the
square is divided into narrow bins, and only bins that an edge comes near need a closer look.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from semtopo.types import Floats, Integers, Point

BINS = 1024
"""Strips on each axis: those near an edge are few, and the two lists stay in the nearest cache."""

ENTRIES_MAX = 2**15
"""Table entries of one window: 45 rectangles with no edge in common, and 256 KiB."""

RECTANGLES_MAX = 2**12
"""Rectangles of one window: laid out in 10 ms."""

NEAR = 1 / 64
"""Strips; an edge so near to the end of a bin is looked at there too: far above what rounding
does to a number of bins in 32 bits."""

SIDE = 3
"""Lengths of reach on each side: wherever one stands in the middle third, nothing is out of it."""


@dataclass(frozen=True, slots=True, eq=False)
class Offsets:
    """Places around a centre: `x`, `y` (n,) in m from it, none farther than `reach` in m.

    `u`, `v` are the same in bins of a window made for this reach.
    """

    x: Floats
    y: Floats
    reach: float
    u: NDArray[np.float32]
    v: NDArray[np.float32]

    @classmethod
    def of(cls, x: Floats, y: Floats, reach: float) -> Offsets:
        """Prepare places so that they can be read from many centres."""
        scale = BINS / (SIDE * reach)
        return cls(x, y, reach, (x * scale).astype(np.float32), (y * scale).astype(np.float32))


@dataclass(frozen=True, slots=True, eq=False)
class _Axis:
    """One axis of a window: where its edges are, and what the bins know of them.

    `places` (bins,) is the point or gap of each bin times `stride`, negative where an edge is
    near. `bounds` are the least numbers of every point and of the gap after it.
    """

    low: float
    scale: float
    edges: Floats
    bounds: Floats
    stride: int
    places: Integers

    @classmethod
    def laid(cls, edges: Floats, low: float, side: float, stride: int) -> _Axis:
        """Lay out the edges that lie between `low` and `low + side`, sorted and distinct."""
        scale = BINS / side
        rounding = 8 * np.spacing(abs(low) + side) * scale
        at, near = (edges - low) * scale, NEAR + rounding
        bins = np.arange(BINS)
        places = 2 * np.searchsorted(at, bins + 0.5) * stride
        first = np.searchsorted(at, bins - near)
        places[np.searchsorted(at, bins + 1 + near) > first] = -(2**40)
        bounds = np.stack([edges, np.nextafter(edges, np.inf)], axis=1).ravel()
        return cls(low, scale, edges, bounds, stride, places)

    def quick(self, offsets: NDArray[np.float32], centre: float) -> Integers:
        """Return point or gap times stride of places at offsets in bins, negative if unsure."""
        start = np.float32((centre - self.low) * self.scale)
        return self.places.take((offsets + start).astype(np.intp), mode="clip")

    def exact(self, coordinates: Floats) -> Integers:
        """Return point or gap times stride of coordinates."""
        return self.bounds.searchsorted(coordinates, side="right") * self.stride


@dataclass(frozen=True, slots=True, eq=False)
class Window:
    """What is on top at each place of a square of side `SIDE` * reach."""

    x: _Axis
    y: _Axis
    table: Integers

    @classmethod
    def laid(
        cls, lows: Floats, highs: Floats, values: Integers, corner: Point, reach: float
    ) -> Window | None:
        """Lay out rectangles, later ones on top, from the corner on; `None` if they are too many.

        `lows`, `highs` are (n, 2); `values` (n + 1,) what to read at each and, last, elsewhere.
        """
        if len(lows) > RECTANGLES_MAX:
            return None
        edges_x, edges_y = (_edges(lows[:, n], highs[:, n], corner[n], reach) for n in (0, 1))
        shape = (2 * len(edges_x) + 1, 2 * len(edges_y) + 1)
        if shape[0] * shape[1] > ENTRIES_MAX:
            return None
        x = _Axis.laid(edges_x, corner[0], SIDE * reach, stride=shape[1])
        y = _Axis.laid(edges_y, corner[1], SIDE * reach, stride=1)
        first = x.exact(lows[:, 0]) // shape[1], y.exact(lows[:, 1])
        last = x.exact(highs[:, 0]) // shape[1], y.exact(highs[:, 1])
        table = np.full(shape, values[-1], dtype=np.intp)
        for value, i, j, k, m in zip(values, *first, *last, strict=False):
            table[i : k + 1, j : m + 1] = value
        return cls(x, y, table.ravel())

    def read(self, centre: Point, offsets: Offsets) -> Integers:
        """Return what is on top at each of the places around a centre."""
        at = self.x.quick(offsets.u, centre[0]) + self.y.quick(offsets.v, centre[1])
        unsure = (at < 0).nonzero()[0]
        if len(unsure):
            x, y = centre[0] + offsets.x[unsure], centre[1] + offsets.y[unsure]
            at[unsure] = self.x.exact(x) + self.y.exact(y)
        return self.table.take(at)


def _edges(lows: Floats, highs: Floats, low: float, reach: float) -> Floats:
    """Return the edges on one axis that lie in the window, sorted and distinct."""
    edges = np.unique(np.concatenate([lows, highs]))
    return edges[(edges >= low) & (edges <= low + SIDE * reach)]
