"""A region cut into triangles, and who lies beside whom.

In comes a region; out goes its constrained Delaunay triangulation as half-edges. Half-edge h, which
is `3 t + k`, runs along side k of triangle t with the triangle on its left, from `origins[h]` to
`origins[following[h]]`; `twins[h]` is the half-edge of the neighbour along the same side, WALL
where the region ends. Lists, not arrays: a search looks at one number at a time.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from semtopo.geometry import Region, as_complex
from semtopo.types import Flags, Floats, Integers, Point

WALL = -1
"""The twin of a half-edge with nothing beyond."""

TOUCHING = 1e-9
"""m; a point so near to a triangle counts as in it: ten times what rounding does to coordinates of
1,000 km, and a tenth of what `inset` keeps clear."""

STRAIGHT = 1e-12
"""m^2, twice the area of a triangle; a corner so flat counts as one: more corners do no harm."""


@dataclass(frozen=True, slots=True, eq=False)
class Triangulation:
    """Triangles of a region, as half-edges; its vertices are `points` in m, map frame.

    `corners` says of each vertex whether a shortest path may bend there: the region's angle at it
    is above 180 degrees. `exits` says of each triangle in a dead end by which of its half-edges one
    gets out, WALL if it is in none: from there, nothing lies beyond it that does not come back.
    """

    points: list[Point]
    origins: list[int]
    following: list[int]
    preceding: list[int]
    twins: list[int]
    corners: list[bool]
    exits: list[int]
    sides: Floats
    """Of each triangle, its three sides as lines a x + b y + c, distances in m: (n, 3, 3); x and y
    count from the first of all points."""

    def locate(self, point: Point) -> list[int]:
        """Return the triangles that a point of the region lies in; on their sides, several."""
        x, y = point[0] - self.points[0][0], point[1] - self.points[0][1]
        depths = (self.sides[..., 0] * x + self.sides[..., 1] * y + self.sides[..., 2]).min(axis=1)
        least = min(float(depths.max()), 0.0) - TOUCHING
        return [int(triangle) for triangle in np.flatnonzero(depths >= least)]


def triangulate(region: Region) -> Triangulation:
    """Return the triangulation of a region; parts that meet in a point are not joined there."""
    corners = _triangles(region)
    _, first, flat = np.unique(as_complex(corners), return_index=True, return_inverse=True)
    points, origins = corners.reshape(-1, 2)[first], flat.reshape(-1)
    count = len(origins)
    following = np.arange(count).reshape(-1, 3)[:, [1, 2, 0]].reshape(-1)
    twins = _twins(origins, origins[following], len(points))
    return Triangulation(
        list(zip(*points.T.tolist(), strict=True)), origins.tolist(), following.tolist(),
        np.arange(count).reshape(-1, 3)[:, [2, 0, 1]].reshape(-1).tolist(), twins.tolist(),
        _bends(points, origins, following, twins).tolist(), _exits(twins.tolist()),
        _side_lines(corners - points[0]),
    )  # fmt: skip


def _triangles(region: Region) -> Floats:
    """Return the triangles (n, 3, 2) of a region, counter-clockwise."""
    cut = shapely.constrained_delaunay_triangles(shapely.get_parts(region))
    corners = shapely.get_coordinates(shapely.get_parts(cut)).reshape(-1, 4, 2)[:, :3]
    one, other = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    clockwise = one[:, 0] * other[:, 1] < one[:, 1] * other[:, 0]
    corners[clockwise] = corners[clockwise][:, ::-1]
    return corners


def _twins(starts: Integers, ends: Integers, count: int) -> Integers:
    """Return the half-edge that runs the other way along each, or WALL."""
    keys, wanted = starts * count + ends, ends * count + starts
    order = np.argsort(keys)
    places = np.minimum(np.searchsorted(keys, wanted, sorter=order), len(keys) - 1)
    found = order[places]
    return np.where(keys[found] == wanted, found, WALL)


def _bends(points: Floats, origins: Integers, following: Integers, twins: Integers) -> Flags:
    """Say of each vertex whether a path may bend there; where walls meet in a point, it may."""
    walls = np.flatnonzero(twins == WALL)
    starts, ends = origins[walls], origins[following[walls]]
    after = np.zeros(len(points), dtype=np.intp)
    after[starts] = ends
    here, back, on = points[ends], points[starts], points[after[ends]]
    one, other = here - back, on - here
    flags = np.bincount(starts, minlength=len(points)) > 1
    flags[ends] |= one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0] < STRAIGHT
    return flags


def _exits(twins: list[int]) -> list[int]:
    """Return the way out of each dead end: triangles with one neighbour left go, one by one."""
    count = len(twins) // 3
    open_sides = [3 - twins[first : first + 3].count(WALL) for first in range(0, len(twins), 3)]
    exits, gone = [WALL] * count, [False] * count
    ends = [triangle for triangle in range(count) if open_sides[triangle] == 1]
    for triangle in ends:
        gone[triangle] = True
        for edge in range(3 * triangle, 3 * triangle + 3):
            beyond = twins[edge] // 3
            if twins[edge] != WALL and not gone[beyond]:
                exits[triangle] = edge
                open_sides[beyond] -= 1
                if open_sides[beyond] == 1:
                    ends.append(beyond)
    return exits


def _side_lines(corners: Floats) -> Floats:
    """Return the sides of triangles as lines with the triangle on the positive side."""
    along = np.roll(corners, -1, axis=1) - corners
    normal = np.stack([-along[..., 1], along[..., 0]], axis=-1)
    normal /= np.maximum(np.linalg.norm(along, axis=-1, keepdims=True), np.finfo(float).tiny)
    offset = -(normal * corners).sum(axis=-1, keepdims=True)
    return np.concatenate([normal, offset], axis=-1)
