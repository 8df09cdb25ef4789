"""Tell readers what happens in sessions, once it is on disk: the log is read, and shared out.

A step that commits here only wakes the one task that watches the database; so it reads no earlier
than the commit, sees the steps of other processes too, and robots wait for no reader. Of each
session that is watched, the last events are kept once for all its readers. A reader is a place in
that list; one that has fallen behind it reads the log by itself, as fast as it takes the events.

For one event loop only.
"""

from __future__ import annotations

import asyncio
import logging
from collections import deque
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from enum import StrEnum
from functools import partial
from typing import Any

import orjson
from fastapi.sse import format_sse_event

from service import store
from service.errors import BusyError, StorageError
from service.metrics import Metrics
from service.sessions import Sessions
from service.settings import Settings

_log = logging.getLogger(__name__)

POLL_SECONDS = 0.5
"""How late a reader may hear of what another process did."""

KEPT_BYTES_MAX = 2**16
"""Of the last events of one session: some 200 steps."""

PAGE = 100
"""Steps read from the log at a time; an answer has some 250 bytes."""


class Ending(StrEnum):
    """Why a feed ends."""

    DELETED = "deleted"
    REVOKED = "revoked"
    STOPPED = "stopped"


@dataclass(frozen=True, slots=True)
class Frame:
    """An event as it goes over the wire, and the step that it tells of."""

    seq: int
    content: bytes


class Feed:
    """What happens in one session, as far as its readers were told: up to step `seq`."""

    def __init__(self, number: int, seq: int) -> None:
        """Begin after step `seq`."""
        self.number = number
        self.seq = self._base = seq
        self.ending: Ending | None = None
        self.readers = 0
        self._kept: deque[Frame] = deque()
        self._bytes = 0
        self._news = asyncio.get_running_loop().create_future()

    @property
    def news(self) -> asyncio.Future[None]:
        """What is done when there is more than now; it must not be cancelled."""
        return self._news

    def after(self, seq: int) -> list[Frame] | None:
        """Return the frames after step `seq`; `None` if they are no longer kept."""
        if seq < self._base:
            return None
        return [frame for frame in self._kept if frame.seq > seq]

    def add(self, frames: list[Frame]) -> None:
        """Take the next frames, and wake all readers once."""
        for frame in frames:
            self._kept.append(frame)
            self._bytes += len(frame.content)
        while self._bytes > KEPT_BYTES_MAX:
            oldest = self._kept.popleft()
            self._bytes -= len(oldest.content)
            self._base = oldest.seq
        self.seq = frames[-1].seq
        self._wake()

    def end(self, ending: Ending) -> None:
        """Tell the readers that nothing more will come."""
        self.ending = ending
        self._wake()

    def _wake(self) -> None:
        told, self._news = self._news, self._news.get_loop().create_future()
        told.set_result(None)


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
    def reading(self, number: int, seq: int) -> Iterator[Feed]:
        """Give the feed of a session, which is at step `seq`, to one reader."""
        feed = self._feeds.get(number) or Feed(number, seq)
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

    async def missed(self, number: int, seq: int) -> list[Frame]:
        """Return the next frames after step `seq` from the log.

        Raises
        ------
        StorageError
            The log cannot be read now.
        """
        query = partial(store.steps_after, session=number, seq=seq, limit=PAGE)
        try:
            taken = await self._read(query)
        except Exception as error:
            raise StorageError("the log cannot be read") from error
        return [_frame(one) for one in taken]

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
                while feed.seq < progress.seq and (frames := await self.missed(number, feed.seq)):
                    feed.add(frames)


def _frame(taken: store.Taken) -> Frame:
    """Return a step as an event: its answer, and the pose."""
    document: dict[str, Any] = orjson.loads(taken.answer)
    data = orjson.dumps({**document, "pose": orjson.Fragment(taken.pose)}).decode()
    return Frame(taken.seq, format_sse_event(event="step", id=str(taken.seq), data_str=data))
