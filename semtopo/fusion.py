"""Fusion: the union of a large region with a small one, at the cost of the small one (R12).

Only what lies in a box around the small region can change. So the large region is cut along the
box, united there, and its rings are put together again: the pieces of ring outside the box, which
stay to the last bit, and those inside, which the union made.

Rings are directed, closed, and keep the region on their left: so each piece knows its next.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TypeAlias

import numpy as np
import shapely
from shapely import LinearRing, MultiPolygon, Polygon

from semtopo.geometry import NO_AREA, Box, Region, polygonal
from semtopo.types import Flags, Floats, Integers

FEW_VERTICES = 500
"""A region of so few vertices is as quickly united as cut and put together."""

MARGIN = 0.0317
"""m; by so much the box is wider than what it surrounds. No round number: borders that run along
the box or end on it are rare, and take the slow way."""

SAME_CROSSING = 1e-9
"""m; crossings so near to each other could be taken for one another."""

Rings: TypeAlias = list[Floats]


class _UnclearError(Exception):
    """The rings cannot be put together: take the slow way."""


@dataclass(frozen=True, slots=True, eq=False)
class _Piece:
    """A piece of ring on one side of a box: where it `start`s and `end`s on it, in m.

    `inner` (n, 2) are the vertices between.
    """

    start: Floats
    end: Floats
    inner: Floats


@dataclass(frozen=True, slots=True, eq=False)
class _Pieces:
    """The rings of a region on one side of a box: `whole` are those that do not cross it."""

    cut: list[_Piece]
    whole: Rings


@dataclass(frozen=True, slots=True, eq=False)
class _Crossings:
    """Where rings cross a box one way, in order: the number of the `side` of a ring, and the point.

    `place` is that number and which share of the side lies before.
    """

    side: Integers
    place: Floats
    xy: Floats

    def __len__(self) -> int:
        """Return how many there are."""
        return len(self.side)

    def of(self, first: int, stop: int) -> _Crossings:
        """Return the crossings of the ring between two vertices."""
        mine = slice(*np.searchsorted(self.side, [first, stop]))
        return _Crossings(self.side[mine], self.place[mine], self.xy[mine])


def fuse(region: Region, addition: Region) -> Region:
    """Return the union of two regions, or the first itself where the second adds no area (R12)."""
    if shapely.get_num_coordinates(region) > FEW_VERTICES:
        try:
            return _fused_within(region, addition, box_around(addition))
        except (_UnclearError, shapely.GEOSException):  # a cut may be no valid polygon
            pass
    fused = polygonal(shapely.union(region, addition))
    return fused if fused.area - region.area > NO_AREA else region


def box_around(region: Region) -> Box:
    """Return the box outside of which fusion with a region changes nothing."""
    low_x, low_y, high_x, high_y = region.bounds
    return (low_x - MARGIN, low_y - MARGIN, high_x + MARGIN, high_y + MARGIN)


def _fused_within(region: Region, addition: Region, box: Box) -> Region:
    """Return the union of a region with one that lies in a box."""
    cut = polygonal(shapely.clip_by_rect(region, *box))
    united = polygonal(shapely.union(cut, addition))
    gain = united.area - cut.area
    if gain <= NO_AREA:
        return region
    outside, inside = _outside(region, box), _inside(united, box)
    fused = _region([*outside.whole, *inside.whole, *_stitched(outside.cut, inside.cut)])
    if abs(fused.area - region.area - gain) > NO_AREA * max(1.0, region.area):
        raise _UnclearError
    return fused


def within(xy: Floats, box: Box) -> Flags:
    """Say of each of (n, 2) points whether it lies in a box."""
    x, y = xy[:, 0], xy[:, 1]
    inside: Flags = (x >= box[0]) & (x <= box[2]) & (y >= box[1]) & (y <= box[3])
    return inside


def _coordinates(region: Region) -> tuple[Floats, Integers]:
    """Return the vertices of all rings of a region, and at which of them each ring begins.

    The last of these is the end.
    """
    rings = shapely.get_rings(shapely.get_parts(shapely.orient_polygons(region)))
    counts = shapely.get_num_coordinates(rings)
    return shapely.get_coordinates(rings), np.concatenate([[0], np.cumsum(counts)])


def _outside(region: Region, box: Box) -> _Pieces:
    """Return the pieces of a region's rings that lie outside a box."""
    xy, begins = _coordinates(region)
    enters, leaves = _crossings(xy, begins, box)
    pieces, whole = [], []
    for first, stop in pairwise(begins.tolist()):
        entering, leaving = enters.of(first, stop), leaves.of(first, stop)
        if len(entering) != len(leaving):
            raise _UnclearError
        if len(entering) > 0:
            pieces += _between(xy[first : stop - 1], first, leaving, entering)
        elif not within(xy[first : first + 1], box).all():
            whole.append(xy[first:stop])
    return _Pieces(pieces, whole)


def _between(ring: Floats, first: int, leaving: _Crossings, entering: _Crossings) -> list[_Piece]:
    """Return the pieces of an open ring from where it leaves a box to where it next enters it."""
    following = np.searchsorted(entering.place, leaving.place) % len(entering)
    return [
        _Piece(
            leaving.xy[one], entering.xy[other],
            _stretch(ring, leaving.side[one] + 1 - first, entering.side[other] - first),
        )
        for one, other in enumerate(following.tolist())
    ]  # fmt: skip


def _crossings(xy: Floats, begins: Integers, box: Box) -> tuple[_Crossings, _Crossings]:
    """Return where rings enter a box, and where they leave it."""
    low, high = np.array(box[:2]), np.array(box[2:])
    near = np.zeros(len(xy) - 1, dtype=np.bool_)
    beyond = np.zeros(len(xy) - 1, dtype=np.bool_)
    for axis in (0, 1):
        for out in (xy[:, axis] < low[axis], xy[:, axis] > high[axis]):
            near |= out[1:] | out[:-1]
            beyond |= out[1:] & out[:-1]
    near &= ~beyond
    near[begins[1:-1] - 1] = False  # no side leads from one ring to the next
    side = np.flatnonzero(near)
    start, along = xy[side], xy[side + 1] - xy[side]
    with np.errstate(divide="ignore", invalid="ignore"):
        to_low, to_high = (low - start) / along, (high - start) / along
    share_in = np.fmin(to_low, to_high).max(axis=1)
    share_out = np.fmax(to_low, to_high).min(axis=1)
    through = share_in < share_out
    found = []
    for share in (share_in, share_out):
        chosen = through & (share > 0) & (share < 1)
        points = start[chosen] + share[chosen, None] * along[chosen]
        found.append(_Crossings(side[chosen], side[chosen] + share[chosen], points))
    return found[0], found[1]


def _inside(region: Region, box: Box) -> _Pieces:
    """Return the pieces of a region's rings that do not run along the box in which it lies."""
    xy, begins = _coordinates(region)
    along = np.zeros(len(xy) - 1, dtype=np.bool_)  # whether a side runs along the box
    touches = np.zeros(len(xy), dtype=np.bool_)
    for number, edge in enumerate(box):
        on = xy[:, number % 2] == edge
        along |= on[1:] & on[:-1]
        touches |= on
    pieces, whole = [], []
    for first, stop in pairwise(begins.tolist()):
        if not touches[first:stop].any():
            whole.append(xy[first:stop])
            continue
        free = ~along[first : stop - 1]
        changes = np.flatnonzero(np.diff(free, prepend=free[-1:]))  # roll would take longer
        starts, ends = changes[free[changes]], changes[~free[changes]]
        if (ends[:1] <= starts[:1]).any():
            ends = np.append(ends[1:], ends[0])
        ring = xy[first : stop - 1]
        for start, end in zip(starts.tolist(), (ends % len(ring)).tolist(), strict=True):
            inner = _stretch(ring, start + 1, end - 1) if end != start + 1 else ring[:0]
            pieces.append(_Piece(ring[start], ring[end], inner))
    return _Pieces(pieces, whole)


def _stretch(ring: Floats, first: int, last: int) -> Floats:
    """Return the vertices of an open ring from one to another, around its end if need be."""
    first, last = first % len(ring), last % len(ring)
    if first <= last:
        return ring[first : last + 1]
    return np.concatenate([ring[first:], ring[: last + 1]])


def _stitched(outside: Sequence[_Piece], inside: Sequence[_Piece]) -> Iterator[Floats]:
    """Yield the closed rings that pieces make: after one outside comes one inside, and so on."""
    if len(outside) != len(inside):
        raise _UnclearError
    inward = _matched(outside, inside)
    outward = _matched(inside, outside)
    left = set(range(len(outside)))
    while left:
        begin = number = min(left)
        parts = []
        while number in left:
            left.remove(number)
            parts += [outside[number].inner, inside[inward[number]].inner]
            number = outward[inward[number]]
        if number != begin:
            raise _UnclearError
        yield np.concatenate([*parts, parts[0][:1]])


def _matched(ending: Sequence[_Piece], starting: Sequence[_Piece]) -> list[int]:
    """Return for each piece which of others starts where it ends."""
    if not ending:
        return []
    ends, starts = np.array([it.end for it in ending]), np.array([it.start for it in starting])
    near = np.abs(ends[:, None] - starts).max(axis=2) < SAME_CROSSING
    if not ((near.sum(axis=0) == 1).all() and (near.sum(axis=1) == 1).all()):
        raise _UnclearError
    matched: list[int] = near.argmax(axis=1).tolist()
    return matched


def _region(rings: Rings) -> Region:
    """Return the region whose rings these are: shells go around counter-clockwise, holes not."""
    made = np.array([shapely.linearrings(ring) for ring in rings], dtype=np.object_)
    around = shapely.is_ccw(made)
    shells, holes = made[around], made[~around]
    if len(shells) == 1:
        return Polygon(shells[0], list(holes))
    bodies = [Polygon(shell) for shell in shells]
    mine: list[list[LinearRing]] = [[] for _ in shells]
    for hole in holes:
        around_it = np.flatnonzero(shapely.covers(bodies, hole))
        if len(around_it) == 0:
            raise _UnclearError
        mine[min(around_it, key=lambda number: bodies[number].area)].append(hole)
    return MultiPolygon([Polygon(*it) for it in zip(shells, mine, strict=True)])
