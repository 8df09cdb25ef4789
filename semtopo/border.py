"""The border of a region: its vertices, ring by ring, and what is known there.

Rings are closed, stand one after another, and keep the region on their left: outer ones go
counter-clockwise, holes clockwise. Each vertex has a mark, which says two things: whether it is a
characteristic point, and why (O_xy); and what lies along the side from it to the next.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from shapely import GeometryType, MultiPolygon, Polygon

from semtopo.geometry import Region, as_complex
from semtopo.types import Bytes, Floats, Integers, Occupancy

POINT = np.uint8(3)
"""The bits of a mark that are the occupancy of the vertex."""

SIDE = np.uint8(4)
"""By so much is the occupancy of a side multiplied in a mark."""


@dataclass(frozen=True, slots=True, eq=False)
class Border:
    """Vertices `xy` (n, 2) in m, map frame, with their `marks` (n,).

    `begins` (rings + 1,) are the places where rings begin, and the end. The last vertex of a ring
    is its first once more, with the same mark. Of a region in parts come the outer ring and the
    holes of the first, then those of the next. `meets` says whether rings may meet in a point.
    """

    xy: Floats
    begins: Integers
    marks: Bytes
    meets: bool = False

    @classmethod
    def of(cls, region: Region, marks: Bytes | None = None) -> Border:
        """Return the border of a region whose rings keep it on their left.

        Without marks, nothing is known of it.
        """
        rings = shapely.get_rings(shapely.get_parts(region))
        xy = shapely.get_coordinates(rings)
        begins = np.zeros(len(rings) + 1, dtype=np.intp)
        np.cumsum(shapely.get_num_coordinates(rings), out=begins[1:])
        known = np.zeros(len(xy), dtype=np.uint8) if marks is None else marks
        return cls(xy, begins, known, meets=comes_twice(xy, begins))

    @property
    def is_known(self) -> bool:
        """Whether anything is known of the border; not so of one that was read back from JSON."""
        return bool(self.marks.any())

    @property
    def occupancy(self) -> Bytes:
        """Why each vertex is a characteristic point, (n,); NONE where it is none."""
        occupancy: Bytes = self.marks & POINT
        return occupancy

    @property
    def sides(self) -> Bytes:
        """What lies along the side from each vertex to the next, (n,); NONE if that is unknown."""
        sides: Bytes = self.marks // SIDE
        return sides

    def points(self) -> tuple[Floats, Bytes]:
        """Return the characteristic points (n, 2) and their occupancies (n,).

        Each stands there once; twice, where two rings touch in it.
        """
        occupancy = self.occupancy
        chosen = occupancy != Occupancy.NONE
        chosen[self.begins[1:] - 1] = False
        return self.xy[chosen], occupancy[chosen]

    def areas(self) -> Floats:
        """Return the area within each ring in m^2, negative for holes, (rings,)."""
        first = self.begins[:-1]
        z = as_complex(self.xy) - complex(*self.xy[0])
        swept = (z[:-1].conj() * z[1:]).imag
        swept[first[1:] - 1] = 0.0  # no side leads from one ring to the next
        areas: Floats = np.add.reduceat(swept, first) / 2
        return areas

    def in_order(self, rings: Iterable[int]) -> Border:
        """Return the border with its rings in another order."""
        spans = [slice(self.begins[ring], self.begins[ring + 1]) for ring in rings]
        lengths = [span.stop - span.start for span in spans]
        return Border(
            np.concatenate([self.xy[span] for span in spans]),
            np.cumsum([0, *lengths]),
            np.concatenate([self.marks[span] for span in spans]),
            meets=self.meets,
        )


def comes_twice(xy: Floats, begins: Integers) -> bool:
    """Say whether rings come to one place twice, besides the one where each ends."""
    rings = len(begins) - 1
    return rings > 1 and len(np.unique(as_complex(xy))) < len(xy) - rings


def taken_together(borders: Sequence[Border]) -> Border:
    """Return the border of regions that meet in points at most."""
    begins, end = [np.zeros(1, dtype=np.intp)], 0
    for border in borders:
        begins.append(border.begins[1:] + end)
        end += len(border.xy)
    return Border(
        np.concatenate([border.xy for border in borders]),
        np.concatenate(begins),
        np.concatenate([border.marks for border in borders]),
        meets=True,
    )


def within(border: Border) -> Region:
    """Return the region within a border: its outer rings are each followed by their holes."""
    rings = len(border.begins) - 1
    shells = [0] if rings == 1 else np.flatnonzero(border.areas() > 0).tolist()
    if len(shells) == 1:
        return _polygon(border)
    ends = [*shells[1:], rings]
    parts = [border.in_order(range(*span)) for span in zip(shells, ends, strict=True)]
    return MultiPolygon([_polygon(part) for part in parts])


def _polygon(border: Border) -> Polygon:
    """Return the region within an outer ring, and holes after it."""
    begins = border.begins
    offsets = (begins, np.array([0, len(begins) - 1]))
    found: Polygon = shapely.from_ragged_array(GeometryType.POLYGON, border.xy, offsets)[0]
    return found


def arranged(border: Border) -> Border:
    """Return a border whose rings are in any order with each outer one followed by its holes.

    Of several outer rings around a hole, the smallest has it.
    """
    rings = len(border.begins) - 1
    if rings == 1:
        return border
    around = border.areas() > 0
    shells = np.flatnonzero(around).tolist()
    if len(shells) > 1:
        return border.in_order(_by_part(border, shells, np.flatnonzero(~around).tolist()))
    first = shells[0]
    return (
        border.in_order([first, *(it for it in range(rings) if it != first)]) if first else border
    )


def _by_part(border: Border, shells: list[int], holes: list[int]) -> list[int]:
    """Return several outer rings, each followed by its holes."""
    bodies = [_polygon(border.in_order([shell])) for shell in shells]
    mine: list[list[int]] = [[shell] for shell in shells]
    for hole in holes:
        ring = shapely.linearrings(border.in_order([hole]).xy)
        around = np.flatnonzero(shapely.covers(bodies, ring)).tolist()
        mine[min(around, key=lambda number: bodies[number].area)].append(hole)
    return [ring for rings in mine for ring in rings]
