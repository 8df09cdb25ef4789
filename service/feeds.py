"""Tell readers what happens in sessions, once it is on disk: the log is read, and shared out.

A step that commits here only wakes the one task that watches the database; so it reads no earlier
than the commit, sees the steps of other processes too, and robots wait for no reader.

For one event loop only.
"""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from typing import Any

import orjson
from fastapi.sse import format_sse_event

from service import store
from service.errors import BusyError, StorageError
from service.feed import Ending, Feed, Frame
from service.metrics import Metrics
from service.sessions import Sessions
from service.settings import Settings
from service.store import Moment

_log = logging.getLogger(__name__)

POLL_SECONDS = 0.5
"""How late a reader may hear of what another process did."""

PAUSE_SECONDS = 0.0002
"""For each reader that was told of something, before the next is told: to tell one takes some
0.04 ms, so that a fifth of the time goes to readers at most, however many there are."""

PAGE = 100
"""Steps read from the log at a time; an answer has some 250 bytes."""


class Feeds:
    """The feeds of all sessions that somebody reads in this process."""

    def __init__(self, sessions: Sessions, settings: Settings, metrics: Metrics) -> None:
        """Begin without readers."""
        self._read = sessions.read
        self._readers_max = settings.readers_max
        self._keys = settings.keys
        self._feeds: dict[int, Feed] = {}
        self._told: set[int] = set()
        self._wake = asyncio.Event()
        self._watch: asyncio.Task[None] | None = None
        self._looked_at = -POLL_SECONDS
        self._closed = False
        self.readers = 0
        metrics.show("event_readers", "Readers of events", lambda: self.readers)

    def check_room(self) -> None:
        """Refuse one more reader where there are as many as there may be.

        Raises
        ------
        BusyError
            It is so.
        """
        if self.readers >= self._readers_max:
            raise BusyError("too many readers are connected")

    @contextmanager
    def reading(self, number: int, newest: Moment) -> Iterator[Feed]:
        """Give the feed of a session, whose newest moment is given, to one reader."""
        feed = self._feeds.get(number) or Feed(number, newest)
        self._feeds[number] = feed
        if self._closed:
            feed.end(Ending.STOPPED)
        elif self._watch is None:
            self._watch = asyncio.get_running_loop().create_task(self._watching())
        self.readers, feed.readers = self.readers + 1, feed.readers + 1
        try:
            yield feed
        finally:
            self.readers, feed.readers = self.readers - 1, feed.readers - 1
            if feed.readers == 0 and self._feeds.get(number) is feed:
                del self._feeds[number]

    def tell(self, number: int) -> None:
        """Take note that something was committed in a session; costs nothing where nobody reads."""
        if number in self._feeds:
            self._told.add(number)
            self._wake.set()

    async def newest(self, number: int) -> Moment | None:
        """Return the newest moment of a session; `None` if it is gone."""
        found = await self._read(partial(store.find_progress, numbers={number}))
        return found[number].moment if number in found else None

    async def missed(self, number: int, moment: Moment) -> list[Frame]:
        """Return the next frames after a moment from the log.

        Raises
        ------
        StorageError
            The log cannot be read now.
        """
        query = partial(store.history_after, session=number, moment=moment, limit=PAGE)
        try:
            happened = await self._read(query)
        except Exception as error:
            raise StorageError("the log cannot be read") from error
        return [_frame(one) for one in happened]

    def close(self) -> None:
        """End every feed, so that no reader keeps the server from stopping."""
        self._closed = True
        self._wake.set()
        for feed in self._feeds.values():
            feed.end(Ending.STOPPED)

    async def _watching(self) -> None:
        """Look at the database as long as somebody reads: when told to, else now and then."""
        try:
            while self._feeds and not self._closed:
                numbers = await self._next()
                try:
                    await self._update(numbers)
                except Exception:  # noqa: BLE001 -- the database may answer again; readers wait
                    _log.warning("the log cannot be read for those who follow it", exc_info=False)
                    await asyncio.sleep(POLL_SECONDS)
        finally:
            self._watch = None

    async def _next(self) -> set[int]:
        """Return the sessions to look at: those that were told of, or all when it is time."""
        loop = asyncio.get_running_loop()
        try:
            async with asyncio.timeout_at(self._looked_at + POLL_SECONDS):
                await self._wake.wait()
        except TimeoutError:
            self._looked_at = loop.time()
            return set(self._feeds)
        self._wake.clear()
        told, self._told = self._told, set()
        return told

    async def _update(self, numbers: set[int]) -> None:
        """Bring feeds up to date."""
        found = await self._read(partial(store.find_progress, numbers=numbers))
        for number in numbers & self._feeds.keys():
            feed, progress = self._feeds[number], found.get(number)
            if progress is None:
                self._feeds.pop(number).end(Ending.DELETED)
            elif self._keys and not progress.is_open:
                self._feeds.pop(number).end(Ending.REVOKED)
            else:
                await self._advance(feed, progress.moment)
        told = sum(self._feeds[number].readers for number in numbers & self._feeds.keys())
        await asyncio.sleep(PAUSE_SECONDS * told)

    async def _advance(self, feed: Feed, newest: Moment) -> None:
        """Bring one feed up to the newest moment."""
        while feed.moment.seq < newest.seq or feed.revision < newest.revision:
            frames = await self.missed(feed.number, feed.moment)
            if not frames:
                break
            feed.add(frames)
            feed.revision = max([feed.revision, *(frame.moment.revision for frame in frames)])


def _frame(one: store.Taken | store.Change) -> Frame:
    """Return a step as an event, its answer and the pose; or a change, what was noted."""
    moment = store.moment_of(one)
    if isinstance(one, store.Taken):
        event, name = "step", f"{moment.seq}"
        more: dict[str, Any] = {"pose": orjson.Fragment(one.pose)}
        document = {**orjson.loads(one.answer), **more}
    else:
        event, name = "change", f"{moment.seq}.{moment.revision}"
        document = {"seq": one.seq, "revision": one.number, "kind": one.kind}
        document["change"] = orjson.Fragment(one.document)
    data = orjson.dumps(document).decode()
    return Frame(moment, format_sse_event(event=event, id=name, data_str=data))
