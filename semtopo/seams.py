"""The border of a union, put together from stretches of two borders that cross each other (R12).

Both keep their region on the left. The border of the union goes along that of the one outside the
other; where it would enter, it goes on along that of the other.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from semtopo.border import POINT, Border
from semtopo.course import UnclearError
from semtopo.geometry import as_complex
from semtopo.sweep import Crossings
from semtopo.types import Bytes, Floats, Integers

SIDES = np.uint8(255) - POINT
"""The bits of a mark that tell of its side: a place where borders cross is no point of a scan."""


class Seams:
    """The crossings of a border with the outline of a sector, and what follows each.

    Raises
    ------
    UnclearError
        The crossings do not fit together.
    """

    def __init__(self, known: Border, outline: Border, found: Crossings, position: complex) -> None:
        """Find out which crossing follows each, along the border and around the sector."""
        self._known, self._outline, self._found = known, outline, found
        side, outline_side = found.place.astype(np.intp), found.around.astype(np.intp)
        rings = known.begins.searchsorted(side, side="right") - 1
        order = found.around.argsort()
        outline_rings = outline.begins.searchsorted(outline_side, side="right") - 1
        after = _following(np.arange(len(side)), rings)
        after_around = _following(order, outline_rings[order])
        enters = found.enters
        if (enters[after] == enters).any() or (enters[after_around] == enters).any():
            raise UnclearError
        self.rings, self.outline_rings = rings.tolist(), outline_rings.tolist()
        self._after, self._after_around = after.tolist(), after_around.tolist()
        self._side, self._outline_side = side.tolist(), outline_side.tolist()
        self._xy = (found.z + position).view(np.float64).reshape(-1, 2)
        self._marks = np.where(enters, outline.marks[outline_side], known.marks[side]) & SIDES

    def joined(self, whole: list[int]) -> Border:
        """Return the border of both together, with some rings of the known one as they are.

        Rings are in any order; none of the outline goes in whole.
        """
        parts = [[*_whole(self._known, ring)] for ring in whole]
        left = dict.fromkeys((~self._found.enters).nonzero()[0].tolist())
        while left:
            parts.append([*self._ring(next(iter(left)), left)])
        lengths = [sum(len(marks) for _, marks in ring) for ring in parts]
        border = Border(
            np.concatenate([xy for ring in parts for xy, _ in ring]),
            np.cumsum([0, *lengths]),
            np.concatenate([marks for ring in parts for _, marks in ring]),
        )
        if len(set(self.rings)) > 1:
            _check_apart(border, len(whole))
        return border

    def _ring(self, first: int, left: dict[int, None]) -> Iterator[tuple[Floats, Bytes]]:
        """Yield the stretches of the ring that goes on from where the known border leaves."""
        leaves = first
        while leaves in left:
            del left[leaves]
            enters = self._after[leaves]
            yield self._point(leaves)
            yield from _stretches(
                self._known, self.rings[leaves], self._side[leaves], self._side[enters],
                wraps=enters <= leaves,
            )  # fmt: skip
            yield self._point(enters)
            leaves = self._after_around[enters]
            yield from _stretches(
                self._outline, self.outline_rings[enters],
                self._outline_side[enters], self._outline_side[leaves],
                wraps=bool(self._found.around[leaves] <= self._found.around[enters]),
            )  # fmt: skip
        if leaves != first:
            raise UnclearError
        yield self._point(first)

    def _point(self, number: int) -> tuple[Floats, Bytes]:
        """Return a crossing as a stretch of one vertex."""
        return self._xy[number : number + 1], self._marks[number : number + 1]


def _check_apart(border: Border, first: int) -> None:
    """Refuse rings, from the `first` on, that come to one place twice: rings that touched met."""
    for begin, end in pairwise(border.begins[first:].tolist()):
        places = as_complex(border.xy[begin : end - 1])
        if len(np.unique(places)) < len(places):
            raise UnclearError


def _following(order: Integers, rings: Integers) -> Integers:
    """Return which crossing follows each on its ring; they stand in `order`, ring by ring."""
    after = np.arange(1, len(order) + 1)
    last = (rings[1:] != rings[:-1]).nonzero()[0]
    firsts = [0, *(last + 1).tolist()]
    after[[*last.tolist(), -1]] = firsts
    following = np.empty(len(order), dtype=np.intp)
    following[order] = order[after]
    return following


def _stretches(
    border: Border, ring: int, start: int, stop: int, *, wraps: bool
) -> Iterator[tuple[Floats, Bytes]]:
    """Yield the vertices between places on two sides of a ring, around its end if it wraps."""
    if wraps:
        end, begin = int(border.begins[ring + 1]), int(border.begins[ring])
        yield border.xy[start + 1 : end], border.marks[start + 1 : end]
        yield border.xy[begin + 1 : stop + 1], border.marks[begin + 1 : stop + 1]
    else:
        yield border.xy[start + 1 : stop + 1], border.marks[start + 1 : stop + 1]


def _whole(border: Border, ring: int) -> Iterator[tuple[Floats, Bytes]]:
    """Yield a ring of a border as it is."""
    span = slice(border.begins[ring], border.begins[ring + 1])
    yield border.xy[span], border.marks[span]
