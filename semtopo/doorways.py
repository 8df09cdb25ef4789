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

from semtopo.geometry import NO_AREA, Polygons, Region, union
from semtopo.scan import Scan
from semtopo.strips import Strips
from semtopo.types import NOWHERE, Integers, SeenName

DOORWAY_OVERLAP = 0.05
"""m; so far a doorway reaches into the zones on both sides, where they are as deep. So its union
with them is in one piece, in spite of rounding, of borders seen from elsewhere, and where the zones
touch without a passage between (R5). What it reaches into was seen to be free, too."""

DOORWAY_GAIN = 1e-3
"""m^2, ten square centimetres: what a scan must add to a known doorway to change it. Each place
sees slightly more of a jamb; without a limit, a doorway would change with every step."""

Ends: TypeAlias = tuple[str, str]
"""The zone ids at both ends of a doorway, the lesser first."""

DoorwayKey: TypeAlias = tuple[str, str, int]
"""The zone ids at both ends, the lesser first, and which of the doorways between them, from 0."""


NO_POLYGONS: Polygons = np.empty(0, dtype=np.object_)


@dataclass(frozen=True, slots=True, eq=False)
class SeenDoorways:
    """Pieces of doorways that one scan shows between two zones, by their names in the scan.

    `pieces` (n,) are the quadrilaterals between neighbouring beams that both went from `source`
    through one passage, or directly, to `target`; `entered` (n,) are the strips of the target that
    they entered there.
    """

    source: SeenName
    target: SeenName
    pieces: Polygons
    entered: Polygons


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
        self, seen: Iterable[tuple[Ends, Polygons]], merges: Mapping[str, str], seq: int
    ) -> Doorways:
        """Return the doorways with pieces that a scan shows between zones of the map.

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
            _arrive(known, former, ends, movers, fresh.get(ends, NO_POLYGONS), seq)
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
    codes = left * size + right
    known = np.isin(codes[entered] - size - 1, codes) & (source != NOWHERE) & (target != NOWHERE)
    entered, pairs = entered[known], (target * len(names) + source)[known]
    if len(entered) == 0:
        return []
    pieces = _pieces(strips.scan, left[entered], right[entered])
    return [
        SeenDoorways(
            names[pair % len(names)], names[pair // len(names)],
            pieces[pairs == pair], strips.polygons(entered[pairs == pair]),
        )
        for pair in np.unique(pairs).tolist()
    ]  # fmt: skip


def _pieces(scan: Scan, left: Integers, right: Integers) -> Polygons:
    """Return the quadrilaterals before intervals that are entered on neighbouring beams."""
    near, far = scan.intervals.near, scan.intervals.far
    inner = np.maximum(far - DOORWAY_OVERLAP, near)
    outer = np.minimum(near + DOORWAY_OVERLAP, far)
    corners = [
        scan.points(left - 1, inner[left - 1]),
        scan.points(left, outer[left]),
        scan.points(right, outer[right]),
        scan.points(right - 1, inner[right - 1]),
    ]
    return np.asarray(shapely.polygons(np.stack(corners, axis=1)), dtype=np.object_)


def ends_of(one: str, other: str) -> Ends:
    """Return two zone ids as the ends of a doorway: the lesser first."""
    return (one, other) if one <= other else (other, one)


def _by_ends(seen: Iterable[tuple[Ends, Polygons]]) -> dict[Ends, Polygons]:
    """Return pieces by the two zones that they lie between, whichever is the source."""
    found: dict[Ends, list[Polygons]] = {}
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


def _fresh(pieces: Polygons, near: list[Doorway]) -> Polygons:
    """Return the pieces that known doorways do not cover, if they add enough."""
    for door in near:
        pieces = pieces[~shapely.covers(door.region, pieces)]
    if len(near) == 1 and len(pieces) > 0:
        beyond = shapely.area(shapely.difference(pieces, near[0].region))
        if beyond.sum() <= DOORWAY_GAIN and shapely.intersects(near[0].region, pieces).all():
            return pieces[:0]
    return pieces


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
    for part in shapely.get_parts(union(np.array(regions, dtype=np.object_))):
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
    if others or region.area - first.region.area > DOORWAY_GAIN:
        known[first.key] = replace(first, region=region, seq=part.seq)
    for door in others:
        del known[door.key]
        former[door.key] = first.key
    return first.key
