"""Strips: the ground between neighbouring beams, and regions made of them (R6).

A strip lies between two neighbouring beams, and joins an interval of the one to an interval of the
other: same label, both from the robot or both not, overlapping in radius. In comes a scan; out go
its strips, and the region of any of them. This room knows nothing of zones.

Strips that follow one another share a whole side, and the ground of two such chains never meets. So
the outline of a chain is known without any union: out along the far ends, and back along the near
ones.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely import MultiPolygon, Polygon

from semtopo.geometry import NO_AREA, Polygons, Region, union
from semtopo.scan import Scan
from semtopo.types import Bytes, Floats, Integers

IN_LINE = 1e-9
"""m; so near to the line between its neighbours, a point is no corner."""

SAME_DIRECTION = 1e-5
"""rad; so near to each other, the first and the last beam of a scan may overlap."""


@dataclass(frozen=True, slots=True, eq=False)
class Strips:
    """Pairs of intervals on neighbouring beams, (strips,) each: the beam before, the beam after.

    None is without area; `left` ascends.
    """

    scan: Scan
    left: Integers
    right: Integers
    near: Floats = field(init=False)
    far: Floats = field(init=False)
    """Where the intervals of the scan start and end, (intervals, 2) in m, map frame."""

    def __post_init__(self) -> None:
        """Lay the corners out once."""
        object.__setattr__(self, "near", self.scan.near_points())
        object.__setattr__(self, "far", self.scan.far_points())

    def polygons(self, chosen: Integers | slice) -> Polygons:
        """Return the chosen strips as polygons."""
        left, right = self.left[chosen], self.right[chosen]
        corners = [self.near[left], self.far[left], self.far[right], self.near[right]]
        return np.asarray(shapely.polygons(np.stack(corners, axis=1)), dtype=np.object_)

    def entering(self) -> Integers:
        """Return the places of the strips that both beams entered from the same label (R15).

        They came through one passage, or directly, from the intervals before those of the strip.
        """
        source = self.scan.intervals.source
        return np.flatnonzero((source[self.left] >= 0) & (source[self.left] == source[self.right]))

    def region(self, chosen: Integers) -> Region:
        """Return the union of the chosen strips, of which there is at least one."""
        if not self.are_chains(chosen):
            return union(self.polygons(chosen))
        parts = [self._outline(*chain) for chain in self._chains(chosen)]
        return parts[0] if len(parts) == 1 else MultiPolygon(parts)

    def are_chains(self, chosen: Integers) -> bool:
        """Say whether no chosen strips but those that follow one another have ground in common.

        Not so where an interval has two partners on one side, nor where a real sensor's last beam
        looks along its first.
        """
        left, right = self.left[chosen], self.right[chosen]
        counts = np.bincount(right, minlength=1)
        if (left[1:] == left[:-1]).any() or counts.max(initial=0) > 1:
            return False
        first, last = self.scan.directions[0], self.scan.directions[-1]
        return self.scan.ring or float(np.abs(first - last).max()) > SAME_DIRECTION

    def _chains(self, chosen: Integers) -> Iterator[tuple[Integers, bool]]:
        """Yield the intervals of each chain, and whether it closes.

        Chains end at intervals without extent: what lies on both sides meets there in a point.
        """
        left, right, spans = self.left[chosen], self.right[chosen], self.scan.intervals
        number = np.full(len(spans), -1)
        number[left] = np.arange(len(chosen))
        number[spans.near == spans.far] = -1
        after = number[right]  # the strip that follows each, or -1
        if (after[:-1] != np.arange(1, len(after))).any():
            yield from _followed(left, right, after)
        elif after[-1] == 0:
            yield left, True
        else:
            yield np.append(left, right[-1]), False

    def _outline(self, intervals: Integers, closed: bool) -> Polygon:  # noqa: FBT001 -- one of a pair
        """Return the polygon around the strips between intervals."""
        spans = self.scan.intervals
        far, far_why = self.far[intervals], spans.far_occupancy[intervals]
        near, near_why = self.near[intervals], spans.near_occupancy[intervals]
        from_robot = spans.near[intervals[0]] == 0
        if closed:
            holes = None if from_robot else [self._cornered(near, near_why)]
            return Polygon(self._cornered(far, far_why), holes)
        if from_robot:
            back, back_why = np.array([self.scan.position]), near_why[:1]
        else:
            extended = (spans.near[intervals] < spans.far[intervals])[::-1]
            back, back_why = near[::-1][extended], near_why[::-1][extended]
        around, why = np.concatenate([far, back]), np.concatenate([far_why, back_why])
        return Polygon(self._cornered(around, why))

    def _cornered(self, ring: Floats, occupancy: Bytes) -> Floats:
        """Return an open ring, without the points on straight walls in an exact scan (R16).

        There they stand in a line, up to rounding; where one kind of border meets another, the
        point stays.
        """
        if not self.scan.exact:
            return ring
        before, after = _before(ring), _after(ring)
        (x, y), (along_x, along_y) = (ring - before).T, (after - before).T
        off = np.abs(x * along_y - y * along_x) > IN_LINE * np.hypot(along_x, along_y)
        off |= (occupancy != _before(occupancy)) | (occupancy != _after(occupancy))
        kept: Floats = ring[off]
        return kept


def _before(ring: NDArray[Any]) -> NDArray[Any]:
    """Return what stands before each of the members of a ring."""
    return np.concatenate([ring[-1:], ring[:-1]])


def _after(ring: NDArray[Any]) -> NDArray[Any]:
    """Return what stands after each of the members of a ring."""
    return np.concatenate([ring[1:], ring[:1]])


def _followed(left: Integers, right: Integers, after: Integers) -> Iterator[tuple[Integers, bool]]:
    """Yield the chains of strips that do not simply stand in a row, by going from one to the next.

    `after` is the number of the strip that follows each, -1 at the end of a chain.
    """
    following = after.tolist()
    heads = set(range(len(following))).difference(following)
    chains = [_walk(head, following) for head in sorted(heads)]
    rest = set(range(len(following))).difference(*chains)
    for chain in chains:
        yield np.append(left[chain], right[chain[-1]]), False
    while rest:
        ring = _walk(min(rest), following)
        rest.difference_update(ring)
        yield left[ring], True


def _walk(start: int, following: list[int]) -> list[int]:
    """Return the numbers from `start` to the end of its chain, or once around."""
    chain = [start]
    while (number := following[chain[-1]]) not in (-1, start):
        chain.append(number)
    return chain


def find_strips(scan: Scan) -> Strips:
    """Return every strip of a scan that has area (R6)."""
    spans = scan.intervals
    left, right = _overlapping(scan)
    near, far = spans.near, spans.far
    east, north = scan.directions[:, 0], scan.directions[:, 1]
    turn = np.abs(east * _after(north) - north * _after(east))
    area = turn[spans.beam[left]] * (far[left] * far[right] - near[left] * near[right]) / 2
    alike = (spans.label[left] == spans.label[right]) & ((near[left] == 0) == (near[right] == 0))
    chosen = alike & (area > NO_AREA)
    return Strips(scan, left[chosen], right[chosen])


def _overlapping(scan: Scan) -> tuple[Integers, Integers]:
    """Return every pair of intervals on neighbouring beams that overlap in radius.

    The intervals of a beam are in order and lie apart, so the partners of each stand in a row; they
    are found without a look at the others, of which a scan may have very many.
    """
    spans, beams = scan.intervals, len(scan.directions)
    # beams are laid end to end; a power of two, so that equal radii stay equal
    length = 2.0 ** np.ceil(np.log2(spans.far.max(initial=1.0)) + 1)
    there = (spans.beam + 1) % beams * length
    here = spans.beam * length
    first = np.searchsorted(here + spans.far, there + spans.near, side="left")
    end = np.searchsorted(here + spans.near, there + spans.far, side="right")
    partners = end - first
    if not scan.ring:
        partners[spans.beam == beams - 1] = 0
    left = np.repeat(np.arange(len(spans)), partners)
    offset = np.arange(len(left)) - np.repeat(np.cumsum(partners) - partners, partners)
    return left, np.repeat(first, partners) + offset
