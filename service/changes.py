"""Change what is noted about a map between its steps: names of zones, and restrictions.

A change waits its turn among the steps of its session, and is on disk before it is answered.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from unicodedata import normalize

import orjson

from semtopo import Atlas, LabelRef, Restriction, UnknownZoneError, ZoneNotes, ZoneRef, resolve_one
from semtopo.following import zone_now
from semtopo.names import closest_names
from semtopo.notes import Restricted
from service import store
from service.clock import now, seconds
from service.errors import (
    BusyError,
    NameTakenError,
    NotesFullError,
    StorageError,
    UnknownPassageError,
    UnknownRestrictionError,
)
from service.feeds import Feeds
from service.hot import HotSession
from service.notes import (
    LIFTED,
    RESTRICTION,
    ZONE,
    on_document,
    restriction_document,
    zone_document,
)
from service.sessions import Sessions

RESTRICTIONS_MAX = 1_000
"""Restrictions of one session at a time."""

CHANGES_MAX = 100_000
"""Changes of one session in all; to read so many back takes half a second."""

ATTEMPTS = 20
"""How often a change is worked out anew because another process was faster."""

Work = Callable[[HotSession], tuple[str, str] | None]
"""Works out a change on a session: its kind and document, or `None` if there is nothing to do."""


@dataclass(frozen=True, slots=True)
class Restrict:
    """Asks for a restriction; names may be any that zones have, `expires_in` is in s."""

    zone: str | None = None
    label: str | None = None
    passage: tuple[str, str, int] | None = None
    closed: bool = False
    factor: float = 1.0
    expires_in: float | None = None


class Changes:
    """The changes of all sessions that are no steps. For one event loop only."""

    def __init__(self, sessions: Sessions, feeds: Feeds) -> None:
        """Work on these sessions, and tell who follows them."""
        self._sessions = sessions
        self._feeds = feeds

    async def note(self, session_id: str, zone_id: str, notes: ZoneNotes) -> HotSession:
        """Note what people call a zone, in place of what was noted before.

        Raises
        ------
        UnknownZoneError
            The map has no zone of that id.
        NameTakenError
            An alias is the name of another zone.
        """

        def work(hot: HotSession) -> tuple[str, str] | None:
            atlas = _atlas(hot)
            _check_names(atlas, zone_id, notes)
            if atlas.notes.get(zone_id, ZoneNotes()) == notes:
                return None
            graph, former = atlas.state.graph, atlas.state.metric.former
            merged = [it for it in hot.notes.zones if zone_now(graph, former, it) == zone_id]
            return ZONE, zone_document(zone_id, notes, [it for it in merged if it != zone_id])

        return await self._change(session_id, work)

    async def restrict(self, session_id: str, asked: Restrict) -> tuple[Restriction, bool]:
        """Restrict something, in place of what held for it; say whether nothing held before.

        Raises
        ------
        UnknownZoneError, AmbiguousZoneError, UnknownPassageError
            What is to be restricted is not in the map.
        InvalidRestrictionError
            The factor is out of range.
        """
        made: list[tuple[Restriction, bool]] = []

        def work(hot: HotSession) -> tuple[str, str] | None:
            atlas = _atlas(hot)
            new, holding = _restriction(atlas, asked), in_force(atlas)
            known = [it for it in holding if it.on == new.on]
            if known:
                new = replace(new, id=known[0].id)
            elif len(holding) >= RESTRICTIONS_MAX:
                raise NotesFullError(f"a session has at most {RESTRICTIONS_MAX} restrictions")
            if len(known) == 1 and replace(known[0], since=new.since, was=None) == new:
                made.append((known[0], False))
                return None
            made.append((new, not known))
            return RESTRICTION, restriction_document(new, [it.id for it in known[1:]])

        await self._change(session_id, work)
        return made[-1]

    async def lift(self, session_id: str, restriction_id: str) -> None:
        """Lift a restriction; raises UnknownRestrictionError."""

        def work(hot: HotSession) -> tuple[str, str]:
            if all(it.id != restriction_id for it in in_force(_atlas(hot))):
                raise UnknownRestrictionError("the session has no such restriction")
            return LIFTED, orjson.dumps({"id": restriction_id}).decode()

        await self._change(session_id, work)

    async def _change(self, session_id: str, work: Work) -> HotSession:
        """Store a change, and return the session with it."""
        async with self._sessions.turn(session_id):
            for _ in range(ATTEMPTS):
                hot = await self._sessions.find(session_id)
                made = work(hot)
                if made is None:
                    return hot
                if hot.notes.revision >= CHANGES_MAX:
                    raise NotesFullError(f"a session has at most {CHANGES_MAX} changes")
                change = store.Change(hot.notes.revision + 1, hot.seq, now(), *made)
                if await self._stored(hot, change):
                    after = replace(hot, notes=hot.notes.after([change]))
                    self._sessions.keep(after)
                    self._feeds.tell(hot.row.number)
                    return after
        raise BusyError("other processes change this session too fast")

    async def _stored(self, hot: HotSession, change: store.Change) -> bool:
        query = partial(store.add_change, session=hot.row.number, change=change)
        try:
            return await self._sessions.commit(query)
        except StorageError:
            self._sessions.forget(hot.row.id)  # whether it was stored is not known
            raise


def _atlas(hot: HotSession) -> Atlas:
    return hot.notes.atlas(hot.state, seconds())


def in_force(atlas: Atlas) -> list[Restriction]:
    """Return the restrictions that hold in an atlas, the oldest first."""
    return [it for it in atlas.restrictions if it.holds(atlas.now)]


def _check_names(atlas: Atlas, zone_id: str, notes: ZoneNotes) -> None:
    """Refuse notes on no zone, and aliases that name another one."""
    nodes = atlas.state.graph.nodes
    if zone_id not in nodes:
        raise UnknownZoneError("the map has no zone of that id", closest_names(atlas, zone_id))
    wanted = set(map(_folded, notes.aliases))
    for node in nodes.values() if wanted else ():
        if node.zone_id == zone_id:
            continue
        names = {node.zone_id, node.label, *atlas.notes.get(node.zone_id, ZoneNotes()).aliases}
        if wanted & set(map(_folded, names)):
            raise NameTakenError("an alias is the name of another zone")


def _folded(name: str) -> str:
    return normalize("NFC", normalize("NFC", name).casefold())


def _restriction(atlas: Atlas, asked: Restrict) -> Restriction:
    """Return the restriction that is asked for, on the map as it is."""
    on = _restricted(atlas, asked)
    name = hashlib.sha256(orjson.dumps(on_document(on))).hexdigest()[:16]
    ends = None if asked.expires_in is None else seconds() + asked.expires_in
    return Restriction(name, on, asked.closed, asked.factor, ends, since=atlas.state.seq)


def _restricted(atlas: Atlas, asked: Restrict) -> Restricted:
    graph = atlas.state.graph
    if asked.label is not None:
        if all(node.label != asked.label for node in graph.nodes.values()):
            close = closest_names(atlas, asked.label)
            raise UnknownZoneError("the map has no zone of that label", close)
        return LabelRef(asked.label)
    if asked.passage is None:
        assert asked.zone is not None  # noqa: S101 -- one of the three is given
        return ZoneRef(resolve_one(atlas, asked.zone))
    source, target, number = asked.passage
    key = (resolve_one(atlas, source), resolve_one(atlas, target), number)
    if key not in graph.passages:
        raise UnknownPassageError("the map has no such passage")
    return key
