"""The border of a union, put together from stretches of two borders that cross each other (R12).

Both keep their region on the left. The border of the union goes along that of the one outside the
other; where it would enter, it goes on along that of the other.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import accumulate, chain, pairwise
from typing import NamedTuple, TypeAlias

import numpy as np

from semtopo.border import POINT, Border, comes_twice
from semtopo.course import UnclearError
from semtopo.geometry import as_complex
from semtopo.sweep import Crossings
from semtopo.types import Floats, Integers

SIDES = np.uint8(255) - POINT
"""The bits of a mark that tell of its side: a place where borders cross is no point of a scan."""

Run: TypeAlias = tuple[int, int]
"""Vertices that follow one another: the number of the first, and of the one after the last."""


class Seams(NamedTuple):
    """Places on the sides of a border, in plain numbers: for so few, arrays would take longer.

    Each place leads along its ring to the next, `after`. The vertices between are in one run, or in
    two where the end of the ring lies between. `side` is the vertex before each place; `rings` are
    those with a place.
    """

    border: Border
    side: list[int]
    after: list[int]
    runs: list[list[Run]]
    rings: set[int]

    @classmethod
    def on(cls, border: Border, place: Floats) -> Seams:
        """Return places on sides: the number of the vertex before, and which share lies before."""
        places, begins = place.tolist(), border.begins.tolist()
        side = list(map(int, places))
        after, runs, rings = [0] * len(side), [list[Run]()] * len(side), set[int]()
        order = iter(sorted(range(len(side)), key=places.__getitem__))
        number = next(order, None)
        for ring, (begin, end) in enumerate(pairwise(begins)):
            if number is None or side[number] >= end:
                continue
            rings.add(ring)
            first = number
            while (following := next(order, None)) is not None and side[following] < end:
                after[number] = following
                runs[number] = [(side[number] + 1, side[following] + 1)]
                number = following
            after[number] = first
            runs[number] = [(side[number] + 1, end), (begin + 1, side[first] + 1)]
            number = following
        return cls(border, side, after, runs, rings)


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
    enters = found.enters.tolist()
    begins = known.border.begins.tolist()
    rings = [
        *([(begins[ring], begins[ring + 1])] for ring in whole), *_rings(known, around, enters)
    ]  # fmt: skip
    lengths = [sum(end - begin for begin, end in runs) for runs in rings]
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


def _rings(known: Seams, around: Seams, enters: list[bool]) -> Iterator[list[Run]]:
    """Yield the new rings, each as runs of vertices.

    Vertices count on from those of the known border to those of the outline, and then to the
    crossings.
    """
    outline = len(known.border.xy)
    crossings = outline + len(around.border.xy)
    for seams in (known, around):
        if any(enters[number] == enters[after] for number, after in enumerate(seams.after)):
            raise UnclearError
    leaving = [number for number, enter in enumerate(enters) if not enter]
    open_ones = set(leaving)
    for first in leaving:
        leaves, ring = first, list[Run]()
        while leaves in open_ones:
            open_ones.remove(leaves)
            enter = known.after[leaves]
            ring += [(crossings + leaves, crossings + leaves + 1), *known.runs[leaves]]
            ring.append((crossings + enter, crossings + enter + 1))
            ring += [(outline + begin, outline + end) for begin, end in around.runs[enter]]
            leaves = around.after[enter]
        if ring:
            yield [*ring, (crossings + first, crossings + first + 1)]


def _numbers(runs: list[Run]) -> Integers:
    """Return the numbers of the vertices of runs."""
    flat: Integers = np.fromiter(chain.from_iterable(runs), np.intp, 2 * len(runs))
    ends = flat[1::2]
    spans = ends - flat[::2]
    stops = spans.cumsum()
    numbers: Integers = np.arange(stops[-1]) + (ends - stops).repeat(spans)
    return numbers
