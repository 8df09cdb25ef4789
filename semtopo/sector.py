"""Sectors: the ground that neighbouring beams of one label swept, and the outline of it (R6).

A sector is a chain of strips: what lies between some beams that follow one another, from `near` to
`far` on each. As the ground of chains never meets, the outline of a sector is known without any
union: out along the far ends, and back along the near ones.

What lies along a side follows from the scan. Between two beams that ended for the same reason, the
border goes on; of two reasons, the lesser holds. Not so where the side runs nearly along the line
of sight: there one beam went past a corner, nobody measured what is in its shadow, and the side is
FREE. So are the sides along the first and the last beam of a sector.
"""

from __future__ import annotations

import math
from itertools import accumulate
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from semtopo.border import POINT, SIDE, Border
from semtopo.fan import Beams
from semtopo.scan import Intervals, Scan
from semtopo.types import Bytes, Complexes, Flags, Floats, Integers, Occupancy, Point

SHADOW = math.tan(math.radians(10))
"""Sides within 10 degrees of the line of sight are shadows: the usual limit for laser scans, as in
the shadow filter of ROS. A wall seen at so small an angle is hardly measured either."""

IN_LINE = 1e-9
"""m; so near to the line between its neighbours, a point is no corner."""

NONE, FREE = int(Occupancy.NONE), int(Occupancy.FREE)


class Sector(NamedTuple):
    """What a chain of strips covers, beam by beam, counter-clockwise; seen from a `position`.

    `along` (n,) are the directions of the beams, `bearings` how far they are turned from the first,
    in rad. `far` and `near` (n,) are distances from the robot in m; `near` is `None` where the
    sector begins at the robot. A `closed` one goes all around. `border` is its outline: first the
    far ends, then the near ones back, without those that are the far ends; or the robot.
    """

    position: complex
    along: Complexes
    bearings: Floats
    near: Floats | None
    far: Floats
    closed: bool
    border: Border

    @property
    def near_sides(self) -> Integers:
        """Which side of the outline goes along the near ends from each beam to the next, (n,)."""
        count = len(self.far)
        if self.closed:
            sides = 2 * count - 1 - np.arange(count)
            sides[-1] = 2 * count
            return sides
        extended = self.near is not None and self.near[-1] < self.far[-1]
        return 2 * count - 3 + int(extended) - np.arange(count)

    @property
    def inner_point(self) -> Point:
        """A point inside: the middle of the first strip, in m, map frame."""
        radii = self.far[:2] if self.near is None else self.far[:2] + self.near[:2]
        middle = self.position + complex((radii * self.along[:2]).sum()) / 4
        return (middle.real, middle.imag)


def sector_of(scan: Scan, intervals: Integers, *, closed: bool) -> Sector:
    """Return the sector of intervals on beams that follow one another, in order of the scan.

    If it is closed, the last beam is followed by the first.
    """
    if scan.fan.clockwise:
        intervals = intervals[::-1]
    spans, fan, position = scan.intervals, scan.fan, complex(*scan.position)
    near, far = spans.near[intervals], spans.far[intervals]
    along, bearings, after, widths = fan.around if closed else Beams.of(fan, spans.beam[intervals])
    from_robot = near[0] == 0

    def line(radii: Floats, why: Bytes) -> Line:
        """Return the vertices at some distances; the side after the last is FREE if open."""
        sides = _sides((radii, radii[after]), (why, why[after]), widths, scan.quantum)
        if not closed:
            sides[-1] = FREE
        return position + radii * along, why + SIDE * sides

    if from_robot:
        outer = line(far, spans.far_occupancy[intervals])
        rings = [outer] if closed else [_apex(outer, position)]
    else:
        outer = line(far, _why_far(spans)[intervals])
        z, marks = line(near, spans.near_occupancy[intervals])
        sides = np.concatenate([marks[-1:], marks[:-1]]) // SIDE  # back, a side begins at its end
        inner = z[::-1], ((marks & POINT) + SIDE * sides)[::-1]
        rings = [outer, inner] if closed else [_around(outer, inner, (near < far)[[0, -1]])]
    border = _border(rings, exact=scan.exact)
    return Sector(position, along, bearings, None if from_robot else near, far, closed, border)


Line: TypeAlias = tuple[Complexes, Bytes]
"""Vertices with their marks."""


def _sides(
    radii: tuple[Floats, Floats], why: tuple[Bytes, Bytes], widths: Floats, quantum: float
) -> Bytes:
    """Return what lies along sides whose ends are on neighbouring beams.

    Of each end comes its distance from the robot in m, and why it is there. `widths` are the sines
    of the angles between the beams; either end may be farther out by less than a quantum, in m.
    """
    (one, other), (reason, other_reason) = radii, why
    sides: Bytes = np.minimum(reason, other_reason)
    if not sides.all():
        sides = np.where(sides == NONE, np.maximum(reason, other_reason), sides)
    jumps = np.abs(one - other) - quantum
    sides[(np.minimum(one, other) * widths < SHADOW * jumps) | (sides == NONE)] = FREE
    return sides


def outlines(scan: Scan, left: Integers, right: Integers) -> Border:
    """Return the outlines of strips, one by one: from intervals on a beam to those on the next."""
    spans = scan.intervals
    widths = scan.fan.widths[spans.beam[left]]
    ends = (right, left) if scan.fan.clockwise else (left, right)
    rings = []
    outer, inner = (spans.far, _why_far(spans)), (spans.near, spans.near_occupancy)
    for (radii, why), (one, other) in ((outer, ends), (inner, ends[::-1])):
        sides = _sides((radii[one], radii[other]), (why[one], why[other]), widths, scan.quantum)
        rings += [(scan.points(one, radii[one]), why[one] + SIDE * sides)]
        rings += [(scan.points(other, radii[other]), why[other] + np.uint8(SIDE * FREE))]
    rings.append(rings[0])
    xy = np.stack([points for points, _ in rings], axis=1).reshape(-1, 2)
    marks = np.stack([it for _, it in rings], axis=1).ravel()
    return Border(xy, len(rings) * np.arange(len(left) + 1), marks)


def _why_far(spans: Intervals) -> Bytes:
    """Return why intervals end; of one without extent, whose ends are one, the greater claim."""
    claims = np.maximum(spans.near_occupancy, spans.far_occupancy)
    return np.where(spans.near < spans.far, spans.far_occupancy, claims)


def _apex(outer: Line, position: complex) -> Line:
    """Return the ring of a sector that begins at the robot and does not go all around."""
    z, marks = outer
    apex = np.array([SIDE * FREE], dtype=np.uint8)
    return np.append(z, position), np.concatenate([marks, apex])


def _around(outer: Line, inner: Line, extended: Flags) -> Line:
    """Return the ring of a sector that begins and ends at some distance from the robot.

    Where its first or last interval has no extent, its two ends are one.
    """
    (far, far_marks), (near, near_marks) = outer, inner
    first, last = extended.tolist()
    if not last:
        far_marks = far_marks.copy()
        far_marks[-1] = (far_marks[-1] & POINT) + SIDE * (near_marks[0] // SIDE)
    back = slice(0 if last else 1, None if first else -1)
    return np.concatenate([far, near[back]]), np.concatenate([far_marks, near_marks[back]])


def _border(rings: list[Line], *, exact: bool) -> Border:
    """Return the border of open rings; of an exact scan, only their corners (R16)."""
    if exact:
        rings = [_cornered(*ring) for ring in rings]
    begins = [0, *accumulate(len(z) + 1 for z, _ in rings)]
    z = np.concatenate([part for ring, _ in rings for part in (ring, ring[:1])])
    marks = np.concatenate([part for _, ring in rings for part in (ring, ring[:1])])
    return Border(z.view(np.float64).reshape(-1, 2), np.array(begins), marks)


def _cornered(z: Complexes, marks: Bytes) -> Line:
    """Return an open ring without the points on straight walls.

    There they stand in a line, up to rounding; where one kind of border meets another, the point
    stays.
    """
    before, along = z - _before(z), _after(z) - z
    off = np.abs((before.conj() * along).imag) > IN_LINE * np.abs(before + along)
    kept = off | (marks != _before(marks)) | (marks & POINT != _after(marks & POINT))
    return z[kept], marks[kept]


def _before(ring: NDArray[Any]) -> NDArray[Any]:
    """Return what stands before each of the members of a ring."""
    return np.concatenate([ring[-1:], ring[:-1]])


def _after(ring: NDArray[Any]) -> NDArray[Any]:
    """Return what stands after each of the members of a ring."""
    return np.concatenate([ring[1:], ring[:1]])
