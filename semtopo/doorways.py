"""Doorways: the ground between two zones, which belongs to neither.

A zone ends where a passage begins. What is known to be free is therefore the zones *and* the ground
of the passages that beams have crossed. In come the intervals of a scan; out go the pieces of
doorways that it shows, and what is known of each doorway, grown scan by scan. This room knows zones
by their names alone.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TypeAlias

import numpy as np
import shapely

from semtopo.geometry import NO_AREA, Polygons, Region, apart, union
from semtopo.scan import Scan
from semtopo.strips import Strips
from semtopo.types import NOWHERE, Flags, Floats, Integers, SeenName

DOORWAY_OVERLAP = 0.05
"""m; so far a doorway reaches into the zones on both sides, where they are as deep. So its union
with them is in one piece, in spite of rounding, of borders seen from elsewhere, and where the zones
touch without a passage between (R5). What it reaches into was seen to be free, too."""

DOORWAY_REACH = 0.02
"""m; a piece changes a known doorway if a corner of it lies further out. From each place one sees
slightly more of a jamb; without a limit, a doorway would change with every step. So much is lost of
a doorway on each side, and a robot must still fit through."""

Ends: TypeAlias = tuple[str, str]
"""The zone ids at both ends of a doorway, the lesser first."""

DoorwayKey: TypeAlias = tuple[str, str, int]
"""The zone ids at both ends, the lesser first, and which of the doorways between them, from 0."""


NO_PIECES: Floats = np.empty((0, 4, 2))


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


@dataclass(frozen=True, slots=True, eq=False)
class Doorway:
    """The ground of one doorway between two zones of the map, in m, map frame.

    `ends` are the zone ids, the lesser first; both are the same where a door stands within a zone.
    `number` tells doorways between the same zones apart, from 0. `since` is the step that found the
    doorway, `seq` the last step that changed it.
    """

    ends: Ends
    number: int
    region: Region
    since: int
    seq: int

    def __post_init__(self) -> None:
        """Make the region ready to be asked often what it covers."""
        shapely.prepare(self.region)

    @property
    def key(self) -> DoorwayKey:
        """What names the doorway in its map."""
        return (*self.ends, self.number)


@dataclass(frozen=True, slots=True, eq=False)
class Doorways(Mapping[DoorwayKey, Doorway]):
    """The doorways of a map by their keys, in order of finding, and where former ones went.

    Doorways that prove to be parts of one become one: the lowest number stays, and the others are
    never used again. `former` leads from their keys to that of the one they became part of.
    """

    known: Mapping[DoorwayKey, Doorway] = field(default_factory=dict)
    former: Mapping[DoorwayKey, DoorwayKey] = field(default_factory=dict)

    def __getitem__(self, key: DoorwayKey) -> Doorway:
        """Return the doorway of that key."""
        return self.known[key]

    def __iter__(self) -> Iterator[DoorwayKey]:
        """Yield the keys in order of finding."""
        return iter(self.known)

    def __len__(self) -> int:
        """Return how many doorways there are."""
        return len(self.known)

    def between(self, one: str, other: str) -> list[Doorway]:
        """Return the doorways between two zones, by their numbers."""
        keys = _keys(self.known, self.former, ends_of(one, other))
        return [self.known[key] for key in keys if key in self.known]

    def updated(
        self, seen: Iterable[tuple[Ends, Floats]], merges: Mapping[str, str], seq: int
    ) -> Doorways:
        """Return the doorways with pieces that a scan shows between zones of the map.

        Of the pieces come the corners (n, 4, 2), and the zones on their sides, in either order.
        Zones are merged into others, from the first id to the second, and their doorways move over.
        What adds little changes nothing; where nothing changes, it is this very object.
        """
        moving = self._moving(merges)
        fresh = {ends: _fresh(parts, self.between(*ends)) for ends, parts in _by_ends(seen).items()}
        if not moving and not any(map(len, fresh.values())):
            return self
        known = {key: door for key, door in self.known.items() if key not in moving}
        former = dict(self.former)
        for ends in dict.fromkeys([*moving.values(), *fresh]):
            movers = [self.known[key] for key, new in moving.items() if new == ends]
            _arrive(known, former, ends, movers, pieces_of(fresh.get(ends, NO_PIECES)), seq)
        changed = Doorways(known, former)
        return changed if moving or changed.changed_since(self) else self

    def _moving(self, merges: Mapping[str, str]) -> dict[DoorwayKey, Ends]:
        """Return the keys of doorways whose ends are no more, and the ends that they get."""
        if not merges:
            return {}
        ends = {key: ends_of(*(merges.get(end, end) for end in key[:2])) for key in self.known}
        return {key: new for key, new in ends.items() if new != key[:2]}

    def changed_since(self, older: Doorways) -> list[Doorway]:
        """Return the doorways that differ from those of an older map."""
        return [door for key, door in self.known.items() if older.known.get(key) is not door]


def seen_doorways(strips: Strips, owner: Integers, names: Sequence[SeenName]) -> list[SeenDoorways]:
    """Return the pieces of doorways of a scan, by target and source.

    `owner` says of each interval in which of the zones it lies, whose names are given, or `NOWHERE`
    (intervals,). A piece lies between two strips of zones that follow on the same two beams.
    """
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


def ends_of(one: str, other: str) -> Ends:
    """Return two zone ids as the ends of a doorway: the lesser first."""
    return (one, other) if one <= other else (other, one)


def _by_ends(seen: Iterable[tuple[Ends, Floats]]) -> dict[Ends, Floats]:
    """Return pieces by the two zones that they lie between, whichever is the source."""
    found: dict[Ends, list[Floats]] = {}
    for (source, target), pieces in seen:
        found.setdefault(ends_of(source, target), []).append(pieces)
    return {
        ends: parts[0] if len(parts) == 1 else np.concatenate(parts)
        for ends, parts in found.items()
    }


def _keys(
    known: Mapping[DoorwayKey, Doorway], former: Mapping[DoorwayKey, DoorwayKey], ends: Ends
) -> Iterator[DoorwayKey]:
    """Yield the keys between two zones that were ever in use, by their numbers."""
    number = 0
    while (key := (*ends, number)) in known or key in former:
        yield key
        number += 1


def _fresh(corners: Floats, near: list[Doorway]) -> Floats:
    """Return the pieces, by their corners, that reach beyond each of some doorways."""
    for door in near:
        xy = corners.reshape(-1, 2)
        within = shapely.contains_xy(door.region, xy)
        if not within.all():
            within[~within] = shapely.dwithin(
                door.region, shapely.points(xy[~within]), DOORWAY_REACH
            )
        corners = corners[~within.reshape(-1, 4).all(axis=1)]
    return corners


def _arrive(
    known: dict[DoorwayKey, Doorway],
    former: dict[DoorwayKey, DoorwayKey],
    ends: Ends,
    movers: list[Doorway],
    pieces: Polygons,
    seq: int,
) -> None:
    """Put into the doorways between two zones those that move there, and pieces just seen."""
    regions = [*(door.region for door in movers), *pieces]
    if not regions:
        return
    for part in apart(union(np.array(regions, dtype=np.object_))):
        if part.area > NO_AREA:
            within = [door for door in movers if door.region.intersects(part)]
            since = min((door.since for door in within), default=seq)
            key = _settle(known, former, Doorway(ends, 0, part, since, seq))
            for door in within:
                former.setdefault(door.key, key)


def _settle(
    known: dict[DoorwayKey, Doorway], former: dict[DoorwayKey, DoorwayKey], part: Doorway
) -> DoorwayKey:
    """Add a part to the doorway that it touches, or as a new one; return that one's key.

    Where it touches several, they become one.
    """
    keys = list(_keys(known, former, part.ends))
    near = [known[key] for key in keys if key in known]
    touched = [door for door in near if door.region.intersects(part.region)]
    if not touched:
        made = replace(part, number=len(keys))
        known[made.key] = made
        return made.key
    first, *others = touched
    region = union(np.array([it.region for it in (part, *touched)], dtype=np.object_))
    if others or region.area - first.region.area > NO_AREA:
        known[first.key] = replace(first, region=region, seq=part.seq)
    for door in others:
        del known[door.key]
        former[door.key] = first.key
    return first.key
