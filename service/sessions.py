"""Find sessions, as they are stored and as they are kept in memory."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from functools import partial
from typing import TypeVar
from weakref import WeakValueDictionary

from sqlalchemy import Connection

from service import store
from service.database import Database
from service.errors import KeyReusedError, UnknownSessionError
from service.hot import HotSession, load
from service.keys import authenticate
from service.metrics import Metrics
from service.recent import Recent
from service.settings import Settings
from service.writer import Writer

Result = TypeVar("Result")


class Sessions:
    """All sessions of one database, as one process sees them. For one event loop only."""

    def __init__(
        self, database: Database, writer: Writer, settings: Settings, metrics: Metrics
    ) -> None:
        """Begin with nothing in memory."""
        self._database = database
        self._writer = writer
        self._hot: Recent[str, HotSession] = Recent(
            settings.hot_sessions_max, settings.hot_bytes_max, lambda hot: hot.weight
        )
        self._turns: WeakValueDictionary[str, asyncio.Lock] = WeakValueDictionary()
        metrics.show("hot_sessions", "Sessions in memory", lambda: len(self._hot))
        metrics.show("hot_bytes", "What they take, as estimated", lambda: self._hot.weight)

    async def create(self, new: store.NewSession) -> HotSession:
        """Store a new session."""
        await self.commit(partial(store.add_session, new=new))
        return await self.find(new.id)

    async def create_once(self, new: store.NewSession, key: store.CreationKey) -> HotSession:
        """Store a new session, or return the one that its key began; raises KeyReusedError."""
        session_id = await self.commit(partial(store.begin_session, new=new, key=key))
        if session_id is None:
            raise KeyReusedError("this Idempotency-Key came with another session before")
        return await self.find(session_id)

    async def find(self, session_id: str) -> HotSession:
        """Return a session as it is stored; raises UnknownSessionError."""
        known, glance = self._hot.get(session_id), self._database.glance
        if known and glance and store.is_at(glance, session_id, known.version):
            return known
        query = partial(load, session_id=session_id, known=known)
        found = await self.read(query)
        newest = self._hot.get(session_id)
        if newest is None or newest.version[0] != found.version[0] or _is_older(newest, found):
            self.keep(found)  # while this was read, a step may have gone further
        return found

    def known(self, session_id: str) -> HotSession | None:
        """Return a session from memory, if it is there; it may be stale."""
        return self._hot.get(session_id)

    def keep(self, hot: HotSession) -> None:
        """Keep in memory what is on disk."""
        self._hot.put(hot.row.id, hot)

    def forget(self, session_id: str) -> None:
        """Drop a session from memory."""
        self._hot.drop(session_id)

    async def page(
        self, owner: int | None, after: int, limit: int, *, newest: bool = False
    ) -> list[store.SessionHead]:
        """Return up to `limit` sessions of an owner, or of all, as `store.list_sessions` does."""
        query = partial(store.list_sessions, owner=owner, after=after, limit=limit, newest=newest)
        return await self.read(query)

    async def authenticate(self, key: str) -> int:
        """Return the number of an API key; raises UnauthorizedError."""
        return await self.read(partial(authenticate, key=key))

    async def delete(self, session_id: str) -> None:
        """Delete a session with all that belongs to it; raises UnknownSessionError."""
        async with self.turn(session_id):
            existed = await self.commit(partial(store.delete_session, session_id=session_id))
            self.forget(session_id)
        if not existed:
            raise UnknownSessionError("there is no session of that id")

    async def delete_unused(self, session_id: str, before: str) -> bool:
        """Delete a session unless it was used since `before`; say whether it was deleted."""
        change = partial(store.delete_unused, session_id=session_id, before=before)
        async with self.turn(session_id):
            deleted = await self.commit(change)
            if deleted:
                self.forget(session_id)
        return deleted

    async def read(self, query: Callable[[Connection], Result]) -> Result:
        """Run a query in a thread, in a transaction that sees one state."""
        return await asyncio.to_thread(self.read_here, query)

    async def commit(self, change: Callable[[Connection], Result]) -> Result:
        """Run a change in a transaction, commit it, and return its result; see `Writer`."""
        return await self._writer.commit(change)

    def turn(self, session_id: str) -> asyncio.Lock:
        """Return the lock that puts changes of a session in order (first come, first served)."""
        lock = self._turns.get(session_id)
        if lock is None:
            lock = self._turns[session_id] = asyncio.Lock()
        return lock

    def read_here(self, query: Callable[[Connection], Result]) -> Result:
        """Run a query in this thread, in a transaction that sees one state."""
        with self._database.reader.begin() as connection:
            return query(connection)


def _is_older(one: HotSession, other: HotSession) -> bool:
    """Say whether one has fewer steps than another, or as many and fewer changes."""
    return one.version < other.version
