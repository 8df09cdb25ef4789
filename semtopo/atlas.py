"""An atlas: a map, what people call its zones, and what is closed or costly in it.

In come a map and notes about it; out goes one value, which names, routes and questions read. The
time comes from outside, since restrictions expire.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

from semtopo.following import notes_now, restrictions_now
from semtopo.graph import PassageKey
from semtopo.mapper import MapState
from semtopo.notes import LabelRef, Restriction, ZoneNotes, ZoneRef


@dataclass(frozen=True, slots=True, eq=False)
class Atlas:
    """A map with notes by zone id and restrictions, at the time `now` in s since the epoch.

    What was noted on a zone or a passage that has become a part of another holds for that (R10,
    R14).
    """

    state: MapState
    notes: Mapping[str, ZoneNotes] = field(default_factory=dict)
    restrictions: tuple[Restriction, ...] = ()
    now: float = 0.0

    def __post_init__(self) -> None:
        """Let notes follow what they are on, and nobody change them from here on."""
        known = self.notes
        fixed = known if isinstance(known, MappingProxyType) else MappingProxyType(known)
        object.__setattr__(self, "notes", notes_now(self.state, fixed))
        object.__setattr__(self, "restrictions", restrictions_now(self.state, self.restrictions))

    @property
    def limits(self) -> Limits:
        """What the restrictions that hold now come to."""
        holding = [one for one in self.restrictions if one.holds(self.now)]
        labels: dict[str, list[str]] = {}
        if any(isinstance(one.on, LabelRef) for one in holding):
            for node in self.state.graph.nodes.values():
                labels.setdefault(node.label, []).append(node.zone_id)
        return Limits.of(holding, labels)


@dataclass(frozen=True, slots=True)
class Limits:
    """Which zones and passages are closed, and the factors of others; factors multiply."""

    closed_zones: frozenset[str] = frozenset()
    closed_passages: frozenset[PassageKey] = frozenset()
    zone_factors: Mapping[str, float] = field(default_factory=dict)
    passage_factors: Mapping[PassageKey, float] = field(default_factory=dict)

    @classmethod
    def of(cls, holding: Iterable[Restriction], labels: Mapping[str, list[str]]) -> Limits:
        """Return what restrictions come to; `labels` gives the zones of each label."""
        closed_zones, closed_passages = set[str](), set[PassageKey]()
        zones: dict[str, float] = {}
        passages: dict[PassageKey, float] = {}
        for one in holding:
            if isinstance(one.on, tuple):
                passages[one.on] = passages.get(one.on, 1.0) * one.factor
                closed_passages |= {one.on} if one.closed else set()
                continue
            on = one.on
            meant = [on.zone_id] if isinstance(on, ZoneRef) else labels.get(on.label, [])
            for zone_id in meant:
                zones[zone_id] = zones.get(zone_id, 1.0) * one.factor
            closed_zones |= set(meant) if one.closed else set()
        return cls(frozenset(closed_zones), frozenset(closed_passages), zones, passages)
