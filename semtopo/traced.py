"""The border of a region that GEOS made of others, with the marks that theirs have.

A side of such a region is a side of one of the others, or a part of it. As a rule it begins or ends
at a vertex of that side, which is found again to the last bit.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from semtopo.border import POINT, SIDE, Border
from semtopo.geometry import Region, as_complex
from semtopo.types import Bytes, Complexes, Integers

Keys: TypeAlias = NDArray[np.uint64]

SPREAD = np.uint64(0x9E3779B97F4A7C15)
"""An odd number with no pattern in its bits: products with it are all over the place."""


def traced(region: Region, sources: Sequence[Border]) -> Border:
    """Return the border of a region, whose rings keep it on their left, with the marks of others.

    Of two claims on one vertex or side, the greater holds. A side that neither begins nor ends at
    a vertex of others is what their nearest side is.
    """
    border = Border.of(region)
    z, marks, starts = _sides_of(sources)
    if not marks.any():
        return border
    keys = _keys(z)
    new, own = _keys(as_complex(border.xy)), border.begins[1:] - 1
    points = _Claims(keys, marks & POINT).at(new)
    claims = marks[starts] // SIDE
    begin, end = keys[starts], keys[starts + 1]
    sides = np.zeros(len(new), dtype=np.uint8)
    for known, wanted in (
        (begin * SPREAD + end, new[:-1] * SPREAD + new[1:]), (begin, new[:-1]), (end, new[1:]),
    ):  # fmt: skip
        open_ones = (sides[:-1] == 0).nonzero()[0]
        sides[open_ones] = _Claims(known, claims).at(wanted[open_ones])
    sides[own] = 1
    open_ones = (sides == 0).nonzero()[0]
    if len(open_ones):
        middles = (as_complex(border.xy)[open_ones] + as_complex(border.xy)[open_ones + 1]) / 2
        sides[open_ones] = claims[_nearest(middles, z[starts], z[starts + 1])]
    sides[own] = sides[border.begins[:-1]]
    return Border(border.xy, border.begins, points + SIDE * sides, border.meets)


def _sides_of(sources: Sequence[Border]) -> tuple[Complexes, Bytes, Integers]:
    """Return vertices and marks of borders, and where their sides begin."""
    begins, count = np.ones(sum(len(it.xy) for it in sources), dtype=np.bool_), 0
    for it in sources:
        begins[it.begins[1:] - 1 + count] = False
        count += len(it.xy)
    xy = np.concatenate([it.xy for it in sources])
    return as_complex(xy), np.concatenate([it.marks for it in sources]), begins.nonzero()[0]


class _Claims:
    """The greatest claim on each of some keys; 0 on all others."""

    def __init__(self, keys: Keys, claims: Bytes) -> None:
        """Sort the claims by their keys."""
        order = keys.argsort()
        ordered = keys[order]
        first = np.concatenate([[0], (ordered[1:] != ordered[:-1]).nonzero()[0] + 1])
        self._keys, self._claims = ordered[first], np.maximum.reduceat(claims[order], first)

    def at(self, keys: Keys) -> Bytes:
        """Return the claims on keys."""
        place = self._keys.searchsorted(keys)
        place[place == len(self._keys)] = 0
        found: Bytes = self._claims[place] * (self._keys[place] == keys)
        return found


def _keys(z: Complexes) -> Keys:
    """Return a number for each place; two places share one by a chance of 2**-64."""
    bits = (z + 0.0).view(np.uint64).reshape(-1, 2)  # + 0.0: zero has one sign
    return bits[:, 0] * SPREAD + bits[:, 1]


def _nearest(places: Complexes, starts: Complexes, ends: Complexes) -> Integers:
    """Return for each of some places which side is nearest to it; the first, if several are."""
    along = ends - starts
    length = np.maximum((along * along.conj()).real, np.finfo(np.float64).tiny)
    found = np.empty(len(places), dtype=np.intp)
    for number, place in enumerate(places.tolist()):  # few: as a rule, none
        share = ((place - starts) * along.conj()).real / length
        found[number] = np.abs(place - starts - np.clip(share, 0, 1) * along).argmin()
    return found
