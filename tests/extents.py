"""Grounds for tests: regions with borders of which something is known, or nothing."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import shapely

from semtopo.border import SIDE, Border
from semtopo.fusion import Extent
from semtopo.geometry import Region
from semtopo.types import Bytes, Occupancy, Point


def marked(region: Region, claims: Mapping[Point, Occupancy]) -> Extent:
    """Return a region with characteristic points; a side has the lesser occupancy of its ends."""
    bare = Extent.of(region)
    why = np.array([claims.get((x, y), 0) for x, y in bare.border.xy.tolist()], dtype=np.uint8)
    after = np.concatenate([why[1:], why[:1]])
    for first, end in zip(bare.border.begins[:-1], bare.border.begins[1:], strict=True):
        after[end - 1] = why[first + 1]
    return Extent(Border(bare.border.xy, bare.border.begins, _marks(why, after)), bare.region)


def _marks(why: Bytes, after: Bytes) -> Bytes:
    sides = np.where(why == 0, after, np.where(after == 0, why, np.minimum(why, after)))
    return (why + SIDE * sides).astype(np.uint8)


def all_around(region: Region, why: Occupancy) -> Extent:
    """Return a region all of whose vertices and sides have one occupancy."""
    corners = map(tuple, shapely.get_coordinates(region).tolist())
    return marked(region, dict.fromkeys(corners, why))


def claims_of(border: Border) -> dict[Point, Occupancy]:
    """Return the characteristic points of a border."""
    xy, why = border.points()
    return {(x, y): Occupancy(it) for (x, y), it in zip(xy.tolist(), why.tolist(), strict=True)}
