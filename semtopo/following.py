"""Where zones and passages went that are no more: what was noted on them follows.

In come a map and notes on what it had once; out go the notes on what that is now. What a map has is
followed no further: so an earlier map has its notes as they were then.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache
from types import MappingProxyType
from typing import Generic, TypeVar

from semtopo.doorways import ends_of
from semtopo.graph import PassageKey, TopologyGraph
from semtopo.mapper import MapState
from semtopo.notes import Restricted, Restriction, ZoneNotes, ZoneRef

NOTES_KEPT = 16
"""Notes that followed in memory; so they are the same ones again, for who keeps names by them."""

Former = Mapping[str, str]
"""Ids of zones that are no more, and of those that they became part of."""


Kept = TypeVar("Kept")


class Same(Generic[Kept]):
    """A value that equals itself alone, so that it can be a key."""

    def __init__(self, value: Kept) -> None:
        """Keep a value."""
        self.value = value

    def __eq__(self, other: object) -> bool:
        """Say whether the other keeps this very value."""
        return isinstance(other, Same) and other.value is self.value

    def __hash__(self) -> int:
        """Return what is the same for the same value."""
        return id(self.value)


def zone_now(graph: TopologyGraph, former: Former, zone_id: str) -> str:
    """Return the zone of which a zone is a part by now (R14); itself if it never merged."""
    while zone_id not in graph.nodes and zone_id in former:
        zone_id = former[zone_id]
    return zone_id


def passage_now(state: MapState, key: PassageKey) -> PassageKey:
    """Return what a passage is by now, after merges of zones (R14) and joins of doorways (R10).

    Its number is that of its doorway, where passages have numbers; else it stays.
    """
    passages, former = state.graph.passages, state.metric.doorways.former
    if key in passages:
        return key
    source, target = (zone_now(state.graph, state.metric.former, end) for end in key[:2])
    door = (*ends_of(*key[:2]), key[2])
    while door in former:
        door = former[door]
        if (source, target, door[2]) in passages:
            return (source, target, door[2])
    return (source, target, key[2])


def notes_now(state: MapState, notes: Mapping[str, ZoneNotes]) -> Mapping[str, ZoneNotes]:
    """Return notes by the ids that zones have by now; as long as no zone merges, the same object.

    A zone that has become several's gets the aliases of all, and the class of the first that has
    one: its own, then those of the others in the order in which they merged.
    """
    if not notes or not state.metric.former:
        return notes
    return _notes_now(state.graph, Same(state.metric.former), Same(notes))


@lru_cache(maxsize=NOTES_KEPT)
def _notes_now(
    graph: TopologyGraph, former: Same[Former], notes: Same[Mapping[str, ZoneNotes]]
) -> Mapping[str, ZoneNotes]:
    moved = [it for it in former.value if it in notes.value and it not in graph.nodes]
    if not moved:
        return notes.value
    found = {it: noted for it, noted in notes.value.items() if it not in moved}
    for zone_id in moved:
        now, more = zone_now(graph, former.value, zone_id), notes.value[zone_id]
        own = found.get(now, ZoneNotes())
        aliases = tuple(dict.fromkeys((*own.aliases, *more.aliases)))
        found[now] = ZoneNotes(aliases, own.zone_class or more.zone_class)
    return MappingProxyType(found)


def restrictions_now(
    state: MapState, restrictions: tuple[Restriction, ...]
) -> tuple[Restriction, ...]:
    """Return restrictions on what their zones and passages are by now."""
    if not state.metric.former and not state.metric.doorways.former:
        return restrictions
    return tuple(_restriction_now(state, one) for one in restrictions)


def _restriction_now(state: MapState, one: Restriction) -> Restriction:
    on: Restricted = one.on
    if isinstance(on, tuple):
        on = passage_now(state, on)
    elif isinstance(on, ZoneRef):
        on = ZoneRef(zone_now(state.graph, state.metric.former, on.zone_id))
    return one if on == one.on else replace(one, on=on, was=one.on)
