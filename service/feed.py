"""What happens in one session, kept once for all its readers: the last events, as they are sent.

A reader is a place in that list; one that has fallen behind it reads the log by itself, as fast as
it takes the events.

For one event loop only.
"""

from __future__ import annotations

import asyncio
from collections import deque
from dataclasses import dataclass
from enum import StrEnum

from service.store import Moment

KEPT_BYTES_MAX = 2**16
"""Of the last events of one session: some 200 steps."""


class Ending(StrEnum):
    """Why a feed ends."""

    DELETED = "deleted"
    REVOKED = "revoked"
    STOPPED = "stopped"


@dataclass(frozen=True, slots=True)
class Frame:
    """An event as it goes over the wire, and the moment that it tells of."""

    moment: Moment
    content: bytes


class Feed:
    """What happens in one session, as far as its readers were told: up to a moment."""

    def __init__(self, number: int, moment: Moment) -> None:
        """Begin after a moment, which holds all changes so far."""
        self.number = number
        self.moment = self._base = moment
        self.revision = moment.revision
        self.ending: Ending | None = None
        self.readers = 0
        self._kept: deque[Frame] = deque()
        self._bytes = 0
        self._news = asyncio.get_running_loop().create_future()

    @property
    def news(self) -> asyncio.Future[None]:
        """What is done when there is more than now; it must not be cancelled."""
        return self._news

    def after(self, moment: Moment) -> list[Frame] | None:
        """Return the frames after a moment; `None` if they are no longer kept."""
        if moment < self._base:
            return None
        return [frame for frame in self._kept if frame.moment > moment]

    def add(self, frames: list[Frame]) -> None:
        """Take the next frames, and wake all readers once."""
        for frame in frames:
            self._kept.append(frame)
            self._bytes += len(frame.content)
        while self._bytes > KEPT_BYTES_MAX:
            oldest = self._kept.popleft()
            self._bytes -= len(oldest.content)
            self._base = oldest.moment
        self.moment = frames[-1].moment
        self._wake()

    def end(self, ending: Ending) -> None:
        """Tell the readers that nothing more will come."""
        self.ending = ending
        self._wake()

    def _wake(self) -> None:
        told, self._news = self._news, self._news.get_loop().create_future()
        told.set_result(None)
