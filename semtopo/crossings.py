"""Crossings: the ground on which the beams of a scan went from zone to zone.

In come the intervals of a scan, and which zone each lies in; out go the pieces of doorways that it
shows. A piece lies between two neighbouring beams that both crossed there.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from semtopo.geometry import Polygons
from semtopo.scan import Scan
from semtopo.strips import Strips
from semtopo.types import NOWHERE, Flags, Floats, Integers, SeenName

DOORWAY_OVERLAP = 0.05
"""m; so far a doorway reaches into the zones on both sides, where they are as deep. So its union
with them is in one piece, in spite of rounding, of borders seen from elsewhere, and where the zones
touch without a passage between (R5). What it reaches into was seen to be free, too."""


@dataclass(frozen=True, slots=True, eq=False)
class SeenDoorways:
    """Pieces of doorways that one scan shows between two zones, by their names in the scan.

    A piece is the quadrilateral between neighbouring beams that both went from `source` through one
    passage, or directly, to `target`: `corners` (n, 4, 2) in m, map frame. `entered` (n,) are the
    places, among the strips of the scan, of those that the beams entered there.
    """

    source: SeenName
    target: SeenName
    corners: Floats
    entered: Integers
    strips: Strips

    def ground(self, chosen: Flags) -> Polygons:
        """Return what the beams of the chosen pieces entered of the target."""
        return self.strips.polygons(self.entered[chosen])


def seen_doorways(strips: Strips, owner: Integers, names: Sequence[SeenName]) -> list[SeenDoorways]:
    """Return the pieces of doorways of a scan, by target and source.

    `owner` says of each interval in which of the zones it lies, whose names are given, or `NOWHERE`
    (intervals,). A piece lies between two strips of zones that follow on the same two beams.
    """
    if strips.scan.intervals.source.max(initial=NOWHERE) == NOWHERE:
        return []
    entered = strips.entering()
    if len(entered) == 0:
        return []
    left, right, size = strips.left, strips.right, len(strips.scan.intervals)
    source, target = owner[left[entered] - 1], owner[left[entered]]
    codes = left * size + right  # they ascend
    before = codes[entered] - size - 1
    known = codes[np.searchsorted(codes, before)] == before  # there is one that is not below
    known &= (source != NOWHERE) & (target != NOWHERE)
    entered, pairs = entered[known], (target * len(names) + source)[known]
    if len(entered) == 0:
        return []
    corners = _corners(strips.scan, left[entered], right[entered])
    return [
        SeenDoorways(
            names[pair % len(names)], names[pair // len(names)],
            corners[pairs == pair], entered[pairs == pair], strips,
        )
        for pair in sorted(set(pairs.tolist()))
    ]  # fmt: skip


def pieces_of(corners: Floats) -> Polygons:
    """Return the pieces with corners (n, 4, 2)."""
    return np.asarray(shapely.polygons(corners), dtype=np.object_)


def _corners(scan: Scan, left: Integers, right: Integers) -> Floats:
    """Return the corners (n, 4, 2) of the pieces before intervals on neighbouring beams."""
    near, far = scan.intervals.near, scan.intervals.far
    places = np.concatenate([left - 1, left, right, right - 1])
    outwards = np.repeat([False, True, True, False], len(left))
    inner = np.maximum(far[places] - DOORWAY_OVERLAP, near[places])
    outer = np.minimum(near[places] + DOORWAY_OVERLAP, far[places])
    points = scan.points(places, np.where(outwards, outer, inner))
    return points.reshape(4, -1, 2).swapaxes(0, 1)
