"""An atlas: a map, what people call its zones, and what is closed or costly in it.

In come a map and notes about it; out goes one value, which names, routes and questions read. The
time comes from outside, since restrictions expire.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TypeAlias

from semtopo.errors import InvalidRestrictionError
from semtopo.graph import PassageKey
from semtopo.mapper import MapState

FACTOR_MIN, FACTOR_MAX = 0.001, 1_000_000.0
"""How much less or more a restriction may let a way cost: a thousandth, a million times."""


@dataclass(frozen=True, slots=True)
class ZoneNotes:
    """What people call a zone beside its label: other names for it, and the class it is of."""

    aliases: tuple[str, ...] = ()
    zone_class: str | None = None


@dataclass(frozen=True, slots=True)
class ZoneRef:
    """One zone, by its id."""

    zone_id: str


@dataclass(frozen=True, slots=True)
class LabelRef:
    """Every zone of a label."""

    label: str


Restricted: TypeAlias = PassageKey | ZoneRef | LabelRef
"""What a restriction is on: one passage, one zone, or all zones of a label."""


@dataclass(frozen=True, slots=True)
class Restriction:
    """Something is closed, or costs `factor` times what it costs else.

    It holds while the time is before `expires_at`, in s since the epoch; always, if that is `None`.
    `since` is the step after which it was made.

    Raises
    ------
    InvalidRestrictionError
        The factor is not between `FACTOR_MIN` and `FACTOR_MAX`.
    """

    id: str
    on: Restricted
    closed: bool = False
    factor: float = 1.0
    expires_at: float | None = None
    since: int = 0

    def __post_init__(self) -> None:
        """Refuse a factor out of range."""
        if not FACTOR_MIN <= self.factor <= FACTOR_MAX:
            raise InvalidRestrictionError(f"factor must be {FACTOR_MIN} to {FACTOR_MAX:.0f}")

    def holds(self, now: float) -> bool:
        """Say whether it holds at a time."""
        return self.expires_at is None or now < self.expires_at


@dataclass(frozen=True, slots=True, eq=False)
class Atlas:
    """A map with notes by zone id and restrictions, at the time `now` in s since the epoch."""

    state: MapState
    notes: Mapping[str, ZoneNotes] = field(default_factory=dict)
    restrictions: tuple[Restriction, ...] = ()
    now: float = 0.0

    def __post_init__(self) -> None:
        """Let nobody change the notes from here on."""
        if not isinstance(self.notes, MappingProxyType):
            object.__setattr__(self, "notes", MappingProxyType(self.notes))

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
