"""The strips of a scan: the ground between neighbouring beams (R6).

A strip lies between two neighbouring beams, and joins an interval of the one to an interval of the
other: same label, both from the robot or both not, overlapping in radius. Zones are made of them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from semtopo.geometry import NO_AREA, Polygons
from semtopo.scan import Scan
from semtopo.types import Integers


@dataclass(frozen=True, slots=True, eq=False)
class Strips:
    """Pairs of intervals on neighbouring beams, (strips,) each: the beam before, the beam after."""

    left: Integers
    right: Integers
    shapes: Polygons
    """Their polygons; none is without area."""

    def entering(self, scan: Scan) -> Integers:
        """Return the places of the strips that both beams entered from the same label (R15).

        They came through one passage, or directly, from the intervals before those of the strip.
        """
        source = scan.intervals.source
        return np.flatnonzero((source[self.left] >= 0) & (source[self.left] == source[self.right]))


def find_strips(scan: Scan) -> Strips:
    """Return every strip of a scan that has area (R6)."""
    left, right = _overlapping(scan)
    spans = scan.intervals
    matching = (spans.label[left] == spans.label[right]) & (
        (spans.near[left] == 0) == (spans.near[right] == 0)
    )
    left, right = left[matching], right[matching]
    corners = np.stack(
        [
            scan.near_points(left),
            scan.far_points(left),
            scan.far_points(right),
            scan.near_points(right),
        ],
        axis=1,
    )
    shapes = np.asarray(shapely.polygons(corners), dtype=np.object_)
    solid = shapely.area(shapes) > NO_AREA
    return Strips(left[solid], right[solid], shapes[solid])


def _overlapping(scan: Scan) -> tuple[Integers, Integers]:
    """Return every pair of intervals on neighbouring beams that overlap in radius.

    The intervals of a beam are in order and lie apart, so the partners of each stand in a row; they
    are found without a look at the others, of which a scan may have very many.
    """
    spans, beams = scan.intervals, len(scan.directions)
    radii, rank = np.unique(np.concatenate([spans.near, spans.far]), return_inverse=True)
    near, far = rank[: len(spans)], rank[len(spans) :]
    here, there = spans.beam * len(radii), (spans.beam + 1) % beams * len(radii)
    first = np.searchsorted(here + far, there + near, side="left")
    end = np.searchsorted(here + near, there + far, side="right")
    partners = end - first
    if not scan.ring:
        partners[spans.beam == beams - 1] = 0
    left = np.repeat(np.arange(len(spans)), partners)
    offset = np.arange(len(left)) - np.repeat(np.cumsum(partners) - partners, partners)
    return left, np.repeat(first, partners) + offset
