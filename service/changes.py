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

from semtopo import LabelRef, Restriction, UnknownZoneError, ZoneNotes, ZoneRef, resolve_one
from semtopo.atlas import Restricted
from semtopo.names import closest_names
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
            _check_names(hot, zone_id, notes)
            if hot.notes.zones.get(zone_id, ZoneNotes()) == notes:
                return None
            return ZONE, zone_document(zone_id, notes)

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
            new = _restriction(hot, asked)
            holding = {it.id: it for it in in_force(hot)}
            made.append((new, new.id not in holding))
            known = holding.get(new.id)
            if known is not None and replace(known, since=new.since) == new:
                made.append((known, False))
                return None
            if len(holding) >= RESTRICTIONS_MAX and known is None:
                raise NotesFullError(f"a session has at most {RESTRICTIONS_MAX} restrictions")
            return RESTRICTION, restriction_document(new)

        await self._change(session_id, work)
        return made[-1]

    async def lift(self, session_id: str, restriction_id: str) -> None:
        """Lift a restriction; raises UnknownRestrictionError."""

        def work(hot: HotSession) -> tuple[str, str]:
            if all(it.id != restriction_id for it in in_force(hot)):
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


def in_force(hot: HotSession) -> list[Restriction]:
    """Return the restrictions of a session that hold now, the oldest first."""
    time = seconds()
    return [it for it in hot.notes.restrictions.values() if it.holds(time)]


def _check_names(hot: HotSession, zone_id: str, notes: ZoneNotes) -> None:
    """Refuse notes on no zone, and aliases that name another one."""
    nodes = hot.state.graph.nodes
    if zone_id not in nodes:
        close = closest_names(hot.notes.atlas(hot.state, seconds()), zone_id)
        raise UnknownZoneError("the map has no zone of that id", close)
    wanted = set(map(_folded, notes.aliases))
    for node in nodes.values() if wanted else ():
        if node.zone_id == zone_id:
            continue
        names = {node.zone_id, node.label, *hot.notes.zones.get(node.zone_id, ZoneNotes()).aliases}
        if wanted & set(map(_folded, names)):
            raise NameTakenError("an alias is the name of another zone")


def _folded(name: str) -> str:
    return normalize("NFC", normalize("NFC", name).casefold())


def _restriction(hot: HotSession, asked: Restrict) -> Restriction:
    """Return the restriction that is asked for, on the session as it is."""
    on = _restricted(hot, asked)
    name = hashlib.sha256(orjson.dumps(on_document(on))).hexdigest()[:16]
    ends = None if asked.expires_in is None else seconds() + asked.expires_in
    return Restriction(name, on, asked.closed, asked.factor, ends, since=hot.seq)


def _restricted(hot: HotSession, asked: Restrict) -> Restricted:
    atlas = hot.notes.atlas(hot.state, seconds())
    if asked.label is not None:
        if all(node.label != asked.label for node in hot.state.graph.nodes.values()):
            close = closest_names(atlas, asked.label)
            raise UnknownZoneError("the map has no zone of that label", close)
        return LabelRef(asked.label)
    if asked.passage is None:
        assert asked.zone is not None  # noqa: S101 -- one of the three is given
        return ZoneRef(resolve_one(atlas, asked.zone))
    source, target, number = asked.passage
    key = (resolve_one(atlas, source), resolve_one(atlas, target), number)
    if key not in hot.state.graph.passages:
        raise UnknownPassageError("the map has no such passage")
    return key
