"""Strips: the ground between neighbouring beams (R6).

A strip lies between two neighbouring beams, and joins an interval of the one to an interval of the
other: same label, both from the robot or both not, overlapping in radius. In comes a scan; out go
its strips, and chains of those that follow one another. This room knows nothing of zones.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import shapely

from semtopo.geometry import NO_AREA, Polygons
from semtopo.scan import Scan
from semtopo.types import Floats, Integers


@dataclass(frozen=True, slots=True, eq=False)
class Strips:
    """Pairs of intervals on neighbouring beams, (strips,) each: the beam before, the beam after.

    None is without area: `areas` in m^2. `left` ascends.
    """

    scan: Scan
    left: Integers
    right: Integers
    areas: Floats

    def polygons(self, chosen: Integers | slice) -> Polygons:
        """Return the chosen strips as polygons."""
        scan, left, right = self.scan, self.left[chosen], self.right[chosen]
        corners = [
            scan.near_points(left), scan.far_points(left),
            scan.far_points(right), scan.near_points(right),
        ]  # fmt: skip
        return np.asarray(shapely.polygons(np.stack(corners, axis=1)), dtype=np.object_)

    def entering(self) -> Integers:
        """Return the places of the strips that both beams entered from the same label (R15).

        They came through one passage, or directly, from the intervals before those of the strip.
        """
        source = self.scan.intervals.source
        one = source[self.left]
        found: Integers = ((one >= 0) & (one == source[self.right])).nonzero()[0]
        return found

    def chains(self, chosen: Integers) -> list[tuple[Integers, bool]]:
        """Return the intervals of each chain of the chosen strips, and whether it closes.

        Chains end at intervals without extent: what lies on both sides meets there in a point.
        There are none if others than strips that follow one another may have ground in common: an
        interval has two partners on one side, a real sensor's last beam looks along its first, or
        its beams are half a turn apart.
        """
        left, right, spans = self.left[chosen], self.right[chosen], self.scan.intervals
        if not self.scan.fan.is_even or self.scan.fan.overlaps:
            return []
        extended = spans.near[left] < spans.far[left]
        if (left[1:] == right[:-1]).all() and extended[1:].all():  # one simply after the other
            closes = bool(extended[0] and right[-1] == left[0])
            return [(left if closes else np.append(left, right[-1]), closes)]
        if (left[1:] == left[:-1]).any() or np.bincount(right).max() > 1:
            return []
        number = np.full(len(spans), -1)
        number[left[extended]] = extended.nonzero()[0]
        return list(_followed(left, right, number[right]))


def _followed(left: Integers, right: Integers, after: Integers) -> Iterator[tuple[Integers, bool]]:
    """Yield the chains of strips, by going from one to the next.

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
    near, far = (spans.near[left], spans.near[right]), (spans.far[left], spans.far[right])
    areas = scan.fan.widths[spans.beam[left]] * (far[0] * far[1] - near[0] * near[1]) / 2
    alike = (spans.label[left] == spans.label[right]) & ((near[0] == 0) == (near[1] == 0))
    chosen = (alike & (areas > NO_AREA)).nonzero()[0]
    return Strips(scan, left[chosen], right[chosen], areas[chosen])


def _overlapping(scan: Scan) -> tuple[Integers, Integers]:
    """Return every pair of intervals on neighbouring beams that overlap in radius.

    The intervals of a beam are in order and lie apart, so the partners of each stand in a row; they
    are found without a look at the others, of which a scan may have very many.
    """
    spans, beams = scan.intervals, len(scan.fan)
    if scan.fan.ring and len(spans) == beams and not spans.near.any():  # one on each, from here
        return np.arange(beams), scan.fan.following
    # beams are laid end to end; a power of two, so that equal radii stay equal
    length = 2.0 ** math.ceil(math.log2(spans.far.max(initial=1.0)) + 1)
    here = spans.beam * length
    there = here + length
    there[spans.beam == beams - 1] = 0.0
    first = (here + spans.far).searchsorted(there + spans.near, side="left")
    partners = (here + spans.near).searchsorted(there + spans.far, side="right") - first
    if not scan.fan.ring:
        partners[spans.beam == beams - 1] = 0
    left = np.arange(len(spans)).repeat(partners)
    first -= partners.cumsum() - partners  # so that each counts on from the one before
    return left, first.repeat(partners) + np.arange(len(left))
