"""The border of a zone as pieces of line: walls, passages, frontiers.

In comes a zone of the map; out go the stretches of its rings, each with its occupancy. A *frontier*
is a piece with occupancy FREE: known free space ends there, and nobody knows what follows.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import shapely

from semtopo.border import Border
from semtopo.metric import MappedZone
from semtopo.types import Bytes, Floats, Occupancy

SETTLED = 20
"""Tolerances; over so long a stretch, a reduced border has one occupancy."""


@dataclass(frozen=True, slots=True, eq=False)
class BorderPiece:
    """A stretch of a zone's border: `line` (n, 2) in m, map frame, n at least 2."""

    occupancy: Occupancy
    line: Floats


@dataclass(frozen=True, slots=True, eq=False)
class PiecedBorder(Border):
    """The border of a zone that was read back in pieces: all that is known of it."""

    pieces: tuple[BorderPiece, ...] = ()

    @classmethod
    def of_pieces(cls, border: Border, pieces: Sequence[BorderPiece]) -> PiecedBorder:
        """Return a border of which these pieces are known."""
        return cls(border.xy, border.begins, border.marks, border.meets, tuple(pieces))

    @property
    def is_known(self) -> bool:
        """Whether anything is known of the border."""
        return len(self.pieces) > 0


def border_pieces(zone: MappedZone) -> tuple[BorderPiece, ...]:
    """Return the border of a zone in pieces, ring by ring; together they are all of it.

    What is there, is known from the scans, side by side (see `sector`); where nothing is known, it
    is FREE. Where borders are reduced (R17), the pieces are those of the core, each reduced to the
    tolerance; what is shorter than a few tolerances goes with what is around it.
    """
    if isinstance(zone.border, PiecedBorder):
        return zone.border.pieces
    border = zone.border if zone.core is None else zone.core.border
    width = 0.0 if zone.core is None else SETTLED * zone.core.tolerance
    sides = np.maximum(border.sides, Occupancy.FREE)
    pieces = [
        piece
        for first, end in pairwise(border.begins.tolist())
        for piece in _pieces(border.xy[first:end], sides[first : end - 1], width)
    ]
    return tuple(pieces if zone.core is None else reduced(pieces, zone.core.tolerance))


def reduced(pieces: Sequence[BorderPiece], tolerance: float) -> list[BorderPiece]:
    """Return pieces with fewer points, nothing of a line farther away than the tolerance in m."""
    counts = [len(piece.line) for piece in pieces]
    if not counts:
        return []
    points = np.concatenate([piece.line for piece in pieces])
    lines = np.asarray(
        shapely.linestrings(points, indices=np.repeat(np.arange(len(counts)), counts))
    )
    closed = shapely.is_closed(lines)  # else one that is small would become a dot
    for keep in (False, True):
        chosen = closed == keep
        lines[chosen] = shapely.simplify(lines[chosen], tolerance, preserve_topology=keep)
    xy, index = shapely.get_coordinates(lines, return_index=True)
    parts = np.split(xy, np.flatnonzero(np.diff(index)) + 1)
    return [BorderPiece(one.occupancy, part) for one, part in zip(pieces, parts, strict=True)]


def _pieces(ring: Floats, sides: Bytes, width: float) -> Iterator[BorderPiece]:
    """Yield the pieces of a closed ring (n, 2), from one change of occupancy to the next.

    `sides` (n - 1,) are the occupancies of its sides.
    """
    if width > 0:
        sides = _settled(sides, np.hypot(*np.diff(ring, axis=0).T), width)
    (changes,) = np.nonzero(sides != np.roll(sides, 1))
    if len(changes) == 0:
        yield BorderPiece(Occupancy(int(sides[0])), ring)
        return
    open_ring = ring[:-1]
    for start, end in zip(changes, np.roll(changes, -1), strict=True):
        stop = end if end > start else end + len(sides)
        places = np.arange(start, stop + 1) % len(sides)
        yield BorderPiece(Occupancy(int(sides[start])), open_ring[places])


def _settled(sides: Bytes, lengths: Floats, width: float) -> Bytes:
    """Return for each side of a ring the occupancy of most of the border around it.

    That is of a stretch `width` long, in m: what is shorter than half of it is not worth a piece.
    """
    around = np.tile(lengths, 3)
    ends = np.concatenate([[0.0], np.cumsum(around)])
    middle = (ends[:-1] + ends[1:])[len(sides) : 2 * len(sides)] / 2
    reach = min(width, ends[len(sides)]) / 2
    shares = []
    for occupancy in Occupancy:
        known = np.concatenate([[0.0], np.cumsum(around * np.tile(sides == occupancy, 3))])
        one, other = (np.interp(middle + way, ends, known) for way in (-reach, reach))
        shares.append(other - one)
    most: Bytes = np.argmax(shares, axis=0).astype(np.uint8)
    return most
