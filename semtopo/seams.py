"""The border of a union, put together from stretches of two borders that cross each other (R12).

Both keep their region on the left. The border of the union goes along that of the one outside the
other; where it would enter, it goes on along that of the other.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import accumulate, pairwise
from typing import NamedTuple

import numpy as np

from semtopo.border import POINT, Border, comes_twice
from semtopo.course import UnclearError
from semtopo.geometry import as_complex
from semtopo.sweep import Crossings
from semtopo.types import Floats, Integers

SIDES = np.uint8(255) - POINT
"""The bits of a mark that tell of its side: a place where borders cross is no point of a scan."""


class Seams(NamedTuple):
    """Places on the sides of a border; each leads along its ring to the next, `after` (places,).

    `side` is the vertex before each place. The vertices from a place to the next are in two runs
    where the end of the ring lies between; elsewhere the second is empty. `begins` and `spans`
    (places, 2) say where the runs begin, and how many they are. `rings` are those with a place.
    """

    border: Border
    side: Integers
    after: Integers
    begins: Integers
    spans: Integers
    rings: frozenset[int]

    @classmethod
    def on(cls, border: Border, place: Floats) -> Seams:
        """Return places on sides: the number of the vertex before, and which share lies before."""
        side, order = place.astype(np.intp), place.argsort()
        after = np.empty_like(order)
        after[order[:-1]] = order[1:]
        runs = list(_by_ring(border, place, order))
        for _, first, last in runs:
            after[last] = first
        begins, spans = np.zeros((2, len(place), 2), dtype=np.intp)
        begins[:, 0], spans[:, 0] = side, side[after]
        spans[:, 0] -= side
        begins += 1
        for ring, first, last in runs:
            begin, end = border.begins[ring], border.begins[ring + 1]
            begins[last, 1] = begin + 1  # a ring's first vertex is its last, too
            spans[last] = end - 1 - side[last], side[first] - begin
        return cls(border, side, after, begins, spans, frozenset(ring for ring, _, _ in runs))


def _by_ring(border: Border, place: Floats, order: Integers) -> Iterator[tuple[int, int, int]]:
    """Yield each ring with places on it, with its first and its last of them.

    `order` is that of the places along the border.
    """
    rings = len(border.begins) - 1
    ends = [len(order)] if rings == 1 else place[order].searchsorted(border.begins[1:]).tolist()
    first = 0
    for ring, end in enumerate(ends):
        if first < end:
            yield ring, int(order[first]), int(order[end - 1])
        first = end


def joined(
    known: Seams, around: Seams, found: Crossings, position: complex, whole: list[int]
) -> Border:
    """Return the border of a region and a sector together, with some known rings as they are.

    It is known where the crossings are on the border of the region and around the sector, which was
    seen from a position in m, map frame. Rings come in any order; those of the outline that are not
    crossed have no part in it.

    Raises
    ------
    UnclearError
        The crossings do not fit together.
    """
    enters = found.enters
    if (enters[known.after] == enters).any() or (enters[around.after] == enters).any():
        raise UnclearError
    leaves, counts = _cycles((~enters).nonzero()[0].tolist(), around.after[known.after].tolist())
    vertices, lengths = _vertices(known, around, leaves, counts)
    begins = known.border.begins
    kept = [np.arange(begins[ring], begins[ring + 1]) for ring in whole]
    chosen = np.concatenate([*kept, vertices])
    z = [as_complex(known.border.xy), as_complex(around.border.xy), found.z + position]
    sides = np.where(enters, around.border.marks[around.side], known.border.marks[known.side])
    marks = np.concatenate([known.border.marks, around.border.marks, sides & SIDES])
    xy = np.concatenate(z)[chosen].view(np.float64).reshape(-1, 2)
    begins = np.array([0, *accumulate([*map(len, kept), *lengths])])
    border = Border(xy, begins, marks[chosen])
    return _checked(border, len(whole)) if known.border.meets else border


def _checked(border: Border, first: int) -> Border:
    """Return a border whose rings may meet; raise if one from the `first` on meets itself."""
    for begin, end in pairwise(border.begins[first:].tolist()):
        if len(np.unique(as_complex(border.xy[begin : end - 1]))) < end - 1 - begin:
            raise UnclearError
    return replace(border, meets=comes_twice(border.xy, border.begins))


def _cycles(leaves: list[int], following: list[int]) -> tuple[Integers, Integers]:
    """Return the places where rings leave a sector, ring by ring, and how many each ring has."""
    order: list[int] = []
    counts: list[int] = []
    open_ones = set(leaves)
    for first in leaves:
        number, before = first, len(order)
        while number in open_ones:
            open_ones.remove(number)
            order.append(number)
            number = following[number]
        if len(order) > before:
            counts.append(len(order) - before)
    return np.array(order), np.array(counts)


def _vertices(
    known: Seams, around: Seams, leaves: Integers, counts: Integers
) -> tuple[Integers, list[int]]:
    """Return the numbers of the vertices of new rings, and how many each ring has.

    They count on from the vertices of the known border to those of the outline, and then to the
    crossings.
    """
    size = len(known.border.xy)
    crossing = size + len(around.border.xy)
    entered, ends = known.after[leaves], counts.cumsum()
    firsts = leaves[ends - counts].repeat(counts)
    spans, begins = np.empty((2, len(leaves), 7), dtype=np.intp)
    begins[:, 1:3], spans[:, 1:3] = known.begins[leaves], known.spans[leaves]
    begins[:, 4:6], spans[:, 4:6] = around.begins[entered], around.spans[entered]
    begins[:, 4:6] += size
    begins[:, 0], begins[:, 3], begins[:, 6] = leaves, entered, firsts
    begins[:, ::3] += crossing
    spans[:, 0] = spans[:, 3] = 1
    spans[:, 6] = 0
    spans[ends - 1, 6] = 1
    flat = spans.ravel()
    stops = flat.cumsum()
    vertices = np.arange(stops[-1]) + (begins.ravel() - stops + flat).repeat(flat)
    return vertices, np.add.reduceat(spans.sum(axis=1), ends - counts).tolist()
