"""The border of a zone as pieces of line: walls, passages, frontiers.

In comes a zone of the map; out go the stretches of its rings, each with its occupancy. A *frontier*
is a piece with occupancy FREE: known free space ends there, and nobody knows what follows.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from semtopo.metric import MappedZone
from semtopo.types import Bytes, Floats, Occupancy
from semtopo.zones import Border

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

    pieces: tuple[BorderPiece, ...]

    @classmethod
    def of(cls, pieces: Sequence[BorderPiece]) -> PiecedBorder:
        """Return the border of at least one piece."""
        lengths = [len(piece.line) for piece in pieces]
        occupancy = np.repeat(np.array([it.occupancy for it in pieces], np.uint8), lengths)
        return cls(np.concatenate([piece.line for piece in pieces]), occupancy, tuple(pieces))


def border_pieces(zone: MappedZone) -> tuple[BorderPiece, ...]:
    """Return the border of a zone in pieces, ring by ring; together they are all of it.

    The side between two border points has the lesser of their occupancies: what lies between a wall
    and the end of sight was not seen. Without any border point on a side, it is FREE. Where borders
    are reduced (R17), the pieces are those of the core, each reduced to the tolerance; what is
    shorter than a few tolerances goes with what is around it.
    """
    if isinstance(zone.border, PiecedBorder):
        return zone.border.pieces
    whole = zone if zone.core is None else zone.core
    width = 0.0 if zone.core is None else SETTLED * zone.core.tolerance
    rings = shapely.get_rings(shapely.get_parts(whole.region))
    pieces = [
        piece
        for ring in rings
        for piece in _pieces(shapely.get_coordinates(ring), whole.border, width)
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


def _pieces(ring: Floats, border: Border, width: float) -> Iterator[BorderPiece]:
    """Yield the pieces of a closed ring (n, 2), from one change of occupancy to the next."""
    sides = _side_occupancies(ring, border)
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


def _side_occupancies(ring: Floats, border: Border) -> Bytes:
    """Return the occupancy of each side of a closed ring (n, 2): n - 1 of them."""
    known = dict(zip(map(tuple, border.xy.tolist()), border.occupancy.tolist(), strict=True))
    nothing = int(Occupancy.NONE)
    claims = np.array([known.get(tuple(xy), nothing) for xy in ring.tolist()], dtype=np.uint8)
    one, other = claims[:-1], claims[1:]
    both = np.where(one == nothing, other, np.where(other == nothing, one, np.minimum(one, other)))
    return np.where(both == nothing, np.uint8(Occupancy.FREE), both).astype(np.uint8)
