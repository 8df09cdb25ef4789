"""The border of a union, put together from stretches of two borders that cross each other (R12).

Both keep their region on the left. The border of the union goes along that of the one outside the
other; where it would enter, it goes on along that of the other.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import accumulate, chain, pairwise
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
    """Places on the sides of a border; each leads along its ring to the next, `after`.

    All but `side`, the vertex before each place, is in plain numbers: for so few, arrays would take
    longer. The vertices between a place and the next are in one run, or in two where the end of the
    ring lies between: in `runs` stand the first of each, and the one after its last. `rings` are
    those with a place.
    """

    border: Border
    side: Integers
    after: list[int]
    runs: list[tuple[int, ...]]
    rings: set[int]

    @classmethod
    def on(cls, border: Border, place: Floats, start: int = 0) -> Seams:
        """Return places on sides: the number of the vertex before, and which share lies before.

        In runs, vertices count from a start.
        """
        sides = place.astype(np.intp)
        side, places = sides.tolist(), place.tolist()
        after, rings = [0] * len(side), set[int]()
        runs: list[tuple[int, ...]] = [()] * len(side)
        order = iter(sorted(range(len(side)), key=places.__getitem__))
        one, base = next(order, None), start + 1
        for ring, (begin, end) in enumerate(pairwise(border.begins.tolist())):
            if one is None or side[one] >= end:
                continue
            rings.add(ring)
            first = one
            while (other := next(order, None)) is not None and side[other] < end:
                after[one], runs[one] = other, (base + side[one], base + side[other])
                one = other
            after[one] = first
            runs[one] = (base + side[one], start + end, base + begin, base + side[first])
            one = other
        return cls(border, sides, after, runs, rings)


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
    begins = known.border.begins.tolist()
    rings = list(_rings(known, around, found.enters.tolist()))
    rings[:0] = [(begins[ring], begins[ring + 1]) for ring in whole]
    lengths = [sum(runs[1::2]) - sum(runs[::2]) for runs in rings]
    chosen = _numbers(list(chain.from_iterable(rings)))
    z = [as_complex(known.border.xy), as_complex(around.border.xy), found.z + position]
    sides = np.where(found.enters, around.border.marks[around.side], known.border.marks[known.side])
    marks = np.concatenate([known.border.marks, around.border.marks, sides & SIDES])
    xy = np.concatenate(z)[chosen].view(np.float64).reshape(-1, 2)
    border = Border(xy, np.array([0, *accumulate(lengths)]), marks[chosen])
    return _checked(border, len(whole)) if known.border.meets else border


def _checked(border: Border, first: int) -> Border:
    """Return a border whose rings may meet; raise if one from the `first` on meets itself."""
    for begin, end in pairwise(border.begins[first:].tolist()):
        if len(np.unique(as_complex(border.xy[begin : end - 1]))) < end - 1 - begin:
            raise UnclearError
    return replace(border, meets=comes_twice(border.xy, border.begins))


def _rings(known: Seams, around: Seams, enters: list[bool]) -> Iterator[tuple[int, ...]]:
    """Yield the new rings, each as runs of vertices.

    Vertices count on from those of the known border to those of the outline, and then to the
    crossings.
    """
    leaves = [not enter for enter in enters]
    for seams in (known, around):
        if [enters[number] for number in seams.after] != leaves:
            raise UnclearError
    crossings = len(known.border.xy) + len(around.border.xy)
    open_ones = {number for number, leave in enumerate(leaves) if leave}
    for first in sorted(open_ones):
        leave, ring = first, list[int]()
        while leave in open_ones:
            open_ones.remove(leave)
            enter = known.after[leave]
            one, other = crossings + leave, crossings + enter
            ring += (one, one + 1, *known.runs[leave], other, other + 1, *around.runs[enter])
            leave = around.after[enter]
        if ring:
            yield (*ring, crossings + first, crossings + first + 1)


def _numbers(runs: list[int]) -> Integers:
    """Return the numbers of the vertices of runs."""
    flat = np.array(runs)
    ends = flat[1::2]
    spans = ends - flat[::2]
    stops = spans.cumsum()
    numbers: Integers = np.arange(stops[-1]) + (ends - stops).repeat(spans)
    return numbers
