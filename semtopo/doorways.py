"""Doorways: the ground between two zones, which belongs to neither.

A zone ends where a passage begins. What is known to be free is therefore the zones *and* the ground
of the passages that beams have crossed. In come the intervals of a scan; out go the pieces of
doorways that it shows, and what is known of each doorway, grown scan by scan. This room knows zones
by their names alone.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import TypeAlias

import numpy as np
import shapely

from semtopo.geometry import NO_AREA, Polygons, Region, union
from semtopo.scan import Scan
from semtopo.types import Integers

DOORWAY_OVERLAP = 0.05
"""m; so far a doorway reaches into the zones on both sides, where they are as deep. So its union
with them is in one piece, in spite of rounding, of borders seen from elsewhere, and where the zones
touch without a passage between (R5). What it reaches into was seen to be free, too."""

DOORWAY_GAIN = 1e-3
"""m^2, ten square centimetres: what a scan must add to a known doorway to change it. Each place
sees slightly more of a jamb; without a limit, a doorway would change with every step."""

DoorwayKey: TypeAlias = tuple[str, str, int]
"""The zone ids at both ends, the lesser first, and which of the doorways between them, from 0."""


@dataclass(frozen=True, slots=True, eq=False)
class SeenDoorways:
    """Pieces of doorways that one scan shows between two zones, by their labels.

    `pieces` (n,) are the quadrilaterals between neighbouring beams that both went from `source`
    through one passage, or directly, to `target`; `entered` (n,) are the strips of the target that
    they entered there.
    """

    source: str
    target: str
    pieces: Polygons
    entered: Polygons


@dataclass(frozen=True, slots=True, eq=False)
class Doorway:
    """The ground of one doorway between two zones of the map, in m, map frame.

    `ends` are the zone ids, the lesser first; both are the same where a door stands within a zone.
    `number` tells doorways between the same zones apart, from 0. `since` is the step that found the
    doorway, `seq` the last step that changed it.
    """

    ends: tuple[str, str]
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
        keys = _keys(self.known, self.former, _ends(one, other))
        return [self.known[key] for key in keys if key in self.known]

    def grown(self, one: str, other: str, pieces: Polygons, seq: int) -> Doorways:
        """Return the doorways with pieces seen between two zones; itself where that adds little."""
        near = self.between(one, other)
        fresh = _fresh(pieces, near)
        if len(fresh) == 0:
            return self
        known, former = dict(self.known), dict(self.former)
        for part in shapely.get_parts(union(fresh)):
            if part.area > NO_AREA:
                _settle(known, former, Doorway(_ends(one, other), 0, part, since=seq, seq=seq))
        grew = len(known) > len(self.known) or any(known.get(it.key) is not it for it in near)
        return Doorways(known, former) if grew else self

    def changed_since(self, older: Doorways) -> list[Doorway]:
        """Return the doorways that differ from those of an older map."""
        return [door for key, door in self.known.items() if older.known.get(key) is not door]


def seen_doorways(
    scan: Scan, left: Integers, right: Integers, strips: Polygons
) -> list[SeenDoorways]:
    """Return the pieces of doorways of a scan, by source and target.

    In come all strips, (n,) each: the interval on the beam before, that on the beam after, and
    their polygon. Between two strips that follow on the same two beams lies a piece of a doorway.
    """
    spans = scan.intervals
    source, target = spans.source[left], spans.label[left]
    codes = left * len(spans) + right
    (entered,) = np.nonzero(
        (source >= 0) & (source == spans.source[right]) & np.isin(codes - len(spans) - 1, codes)
    )
    if len(entered) == 0:
        return []
    pieces = _pieces(scan, left[entered], right[entered])
    count = len(scan.labels)
    pairs, number = np.unique(source[entered] * count + target[entered], return_inverse=True)
    found = [
        SeenDoorways(
            scan.labels[pair // count], scan.labels[pair % count],
            pieces[number == place], strips[entered[number == place]],
        )
        for place, pair in enumerate(pairs.tolist())
    ]  # fmt: skip
    return sorted(found, key=lambda seen: (seen.source, seen.target))


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


def _ends(one: str, other: str) -> tuple[str, str]:
    return (min(one, other), max(one, other))


def _keys(
    known: Mapping[DoorwayKey, Doorway],
    former: Mapping[DoorwayKey, DoorwayKey],
    ends: tuple[str, str],
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


def _settle(
    known: dict[DoorwayKey, Doorway], former: dict[DoorwayKey, DoorwayKey], new: Doorway
) -> DoorwayKey:
    """Put a piece into known doorways, by its ends: return the key of what it became part of."""
    keys = list(_keys(known, former, new.ends))
    touched = [
        known[key] for key in keys if key in known and known[key].region.intersects(new.region)
    ]
    if not touched:
        made = replace(new, number=len(keys))
        known[made.key] = made
        return made.key
    first, *others = touched
    region = union(np.array([new.region, *(door.region for door in touched)], dtype=np.object_))
    if others or region.area - first.region.area > DOORWAY_GAIN:
        known[first.key] = replace(first, region=region, seq=new.seq)
    for door in others:
        del known[door.key]
        former[door.key] = first.key
    return first.key
