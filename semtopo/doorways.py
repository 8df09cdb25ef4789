"""Doorways: the ground between two zones, which belongs to neither.

A zone ends where a passage begins. What is known to be free is therefore the zones *and* the ground
of the passages that beams have crossed. In come the pieces that a scan shows; out goes what is
known of each doorway, grown scan by scan. This room knows zones by their names alone.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import TypeAlias

import numpy as np
import shapely

from semtopo.crossings import DOORWAY_OVERLAP, pieces_of
from semtopo.geometry import NO_AREA, TOUCH, Polygons, Region, apart, union
from semtopo.types import Flags, Floats

DOORWAY_REACH = 0.01
"""m; a piece changes a known doorway if the way across, from zone to zone, leads further out. From
each place one sees slightly more of a jamb; without a limit, a doorway would change with every
step. So much is lost of a doorway on each side, and a robot must still fit through."""

DOORWAY_DEPTH = 0.04
"""m; and so much further a piece may reach into a zone: less than DOORWAY_OVERLAP, so that what is
known of the doorway overlaps with the zone there, too."""

Ends: TypeAlias = tuple[str, str]
"""The zone ids at both ends of a doorway, the lesser first."""

DoorwayKey: TypeAlias = tuple[str, str, int]
"""The zone ids at both ends, the lesser first, and which of the doorways between them, from 0."""


NO_PIECES: Floats = np.empty((0, 4, 2))


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
    """Return all pieces, by their corners, if one reaches beyond each of some doorways; else none.

    Where a doorway changes it takes in all that the scan shows of it, and so it changes less often.
    """
    new = corners
    for door in near:
        deep = _reaches_beyond(door.region, new, DOORWAY_DEPTH)
        new = new[deep | _reaches_beyond(door.region, _across(new), DOORWAY_REACH)]
    return corners if len(new) else new


def _reaches_beyond(region: Region, corners: Floats, reach: float) -> Flags:
    """Say of pieces (n, 4, 2) whether a corner is further than so much, in m, from a region."""
    xy = corners.reshape(-1, 2)
    within = shapely.contains_xy(region, xy)
    if not within.all():
        within[~within] = shapely.dwithin(region, shapely.points(xy[~within]), reach)
    beyond: Flags = np.logical_not(within.reshape(-1, 4).all(axis=1))
    return beyond


def _across(corners: Floats) -> Floats:
    """Return pieces (n, 4, 2) without what reaches into the zones on both sides."""
    ways = corners[:, [1, 0, 3, 2]] - corners  # along the beams: from corner 0 to 1, and 3 to 2
    lengths = np.maximum(np.hypot(ways[..., 0], ways[..., 1]), TOUCH)[..., np.newaxis]
    across: Floats = corners + ways * np.minimum(DOORWAY_OVERLAP / lengths, 0.5)
    return across


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
