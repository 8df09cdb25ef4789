"""What people noted about a map: names of its zones, and what is closed or costly.

In come stored changes, in order; out goes what holds after them.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import datetime
from types import MappingProxyType
from typing import Any

import orjson

from semtopo import Atlas, LabelRef, MapState, Restriction, ZoneNotes, ZoneRef
from semtopo.notes import Restricted
from service.store import Change

ZONE, RESTRICTION, LIFTED = "zone", "restriction", "lifted"
"""The kinds of changes."""


@dataclass(frozen=True, slots=True, eq=False)
class Notes:
    """The notes on a map after `revision` changes: by zone id, and restrictions by id."""

    revision: int = 0
    zones: Mapping[str, ZoneNotes] = field(default_factory=dict)
    restrictions: Mapping[str, Restriction] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Let nobody change the zones from here on; so the names of their atlas can be kept."""
        object.__setattr__(self, "zones", MappingProxyType(self.zones))

    def after(self, changes: Iterable[Change]) -> Notes:
        """Return the notes after some more changes."""
        zones, restrictions, revision = dict(self.zones), dict(self.restrictions), self.revision
        for change in changes:
            given = orjson.loads(change.document)
            revision = change.number
            match change.kind:
                case "zone":
                    _drop(zones, given)
                    zones[given["zone"]] = ZoneNotes(tuple(given["aliases"]), given["class"])
                case "restriction":
                    _drop(restrictions, given)
                    restrictions[given["id"]] = _restriction(given, change.seq)
                case _:
                    restrictions.pop(given["id"], None)
        return Notes(revision, zones, restrictions)

    def atlas(self, state: MapState, now: float) -> Atlas:
        """Return a map with these notes, at a time in s since the epoch."""
        return Atlas(state, self.zones, tuple(self.restrictions.values()), now)

    def version(self, now: float) -> str:
        """Return what tells these notes, at a time, from all others of the same session.

        It is empty where nothing was ever noted.
        """
        if not self.revision:
            return ""
        ended = sum(not one.holds(now) for one in self.restrictions.values())
        return f"-{self.revision}.{ended}" if ended else f"-{self.revision}"


def zone_document(zone_id: str, notes: ZoneNotes, over: Sequence[str] = ()) -> str:
    """Return the notes on a zone as they are stored; those on zones `over` are no more."""
    given = {"zone": zone_id, "aliases": notes.aliases, "class": notes.zone_class}
    return orjson.dumps({**given, **_over(over)}).decode()


def restriction_document(one: Restriction, over: Sequence[str] = ()) -> str:
    """Return a restriction as it is stored; those with ids `over` are no more."""
    given = {
        "id": one.id, **on_document(one.on), "closed": one.closed, "factor": one.factor,
        "expires_at": one.expires_at,
    }  # fmt: skip
    return orjson.dumps({**given, **_over(over)}).decode()


def _over(ids: Sequence[str]) -> dict[str, Any]:
    return {"over": ids} if ids else {}


def _drop(noted: dict[str, Any], given: Mapping[str, Any]) -> None:
    """Remove what a change takes the place of, beside what has the same id."""
    for one in given.get("over", ()):
        noted.pop(one, None)


def on_document(on: Restricted) -> dict[str, Any]:
    """Return what a restriction is on, as JSON has it."""
    match on:
        case ZoneRef(zone_id):
            return {"zone": zone_id}
        case LabelRef(label):
            return {"label": label}
        case (source, target, number):
            n = {"n": number} if number else {}
            return {"passage": {"source": source, "target": target, **n}}


def epoch(time: str) -> float:
    """Return a time in ISO 8601 as s since the epoch."""
    return datetime.fromisoformat(time).timestamp()


def _restriction(given: Mapping[str, Any], seq: int) -> Restriction:
    if "passage" in given:
        passage = given["passage"]
        on: Restricted = (passage["source"], passage["target"], passage.get("n", 0))
    else:
        on = ZoneRef(given["zone"]) if "zone" in given else LabelRef(given["label"])
    return Restriction(
        given["id"], on, given["closed"], given["factor"], given["expires_at"], since=seq
    )
