"""Server-sent events: one response that goes on for as long as its reader stays.

It holds no queue. The reader's place is the number of the last step that was sent; what comes after
is asked for when the connection takes more, so a slow reader costs no more than a quick one.
"""

from __future__ import annotations

import asyncio
import re

from fastapi import Response
from fastapi.sse import KEEPALIVE_COMMENT, format_sse_event
from starlette.types import Receive, Scope, Send

from service.errors import InvalidRequestError, StorageError
from service.feed import Ending, Feed
from service.feeds import Feeds
from service.schemas.steps import SEQ_MAX
from service.store import Moment

HEARTBEAT_SECONDS = 15.0
"""So that what lies between does not take the connection for dead."""

RETRY_MS = 1_000

_ID = re.compile(r"([0-9]{1,10})(?:\.([0-9]{1,10}))?")


def event_id(header: str | None) -> Moment | None:
    """Return the moment that Last-Event-ID names: `SEQ`, or `SEQ.REVISION` after a change."""
    if header is None:
        return None
    found = _ID.fullmatch(header)
    moment = None if found is None else Moment(int(found[1]), int(found[2] or 0))
    if moment is None or max(moment) > SEQ_MAX:
        raise InvalidRequestError("Last-Event-ID must be the id of an event of this session")
    return moment


class EventStream(Response):
    """The events of a session after a moment, in order, none left out, and those to come."""

    media_type = "text/event-stream"

    def __init__(self, feeds: Feeds, number: int, newest: Moment, after: Moment) -> None:
        """Begin after a moment; the session with this row number is at its newest one.

        Raises
        ------
        BusyError
            There are as many readers as there may be.
        """
        super().__init__(headers={"Cache-Control": "no-store", "X-Accel-Buffering": "no"})
        del self.headers["Content-Length"]
        feeds.check_room()
        self._feeds = feeds
        self._number = number
        self._newest = newest
        self._after = after

    async def __call__(self, _scope: Scope, receive: Receive, send: Send) -> None:
        """Send events until the reader goes away, or the feed ends."""
        start = {"type": "http.response.start", "status": 200, "headers": self.raw_headers}
        await send(start)
        gone = asyncio.ensure_future(_disconnected(receive))
        try:
            with self._feeds.reading(self._number, self._newest) as feed:
                last = await self._send_all(feed, gone, send)
            await send({"type": "http.response.body", "body": last})
        finally:
            gone.cancel()

    async def _send_all(self, feed: Feed, gone: asyncio.Future[None], send: Send) -> bytes:
        """Send what there is and what comes; return what is left to be sent when it ends."""
        # an id without data: who is cut off before the first event knows where to go on
        content = format_sse_event(id=".".join(map(str, self._after)), retry=RETRY_MS)
        while not gone.done():
            if content:
                await send({"type": "http.response.body", "body": content, "more_body": True})
            news, ending = feed.news, feed.ending
            try:
                content = await self._next(feed)
            except StorageError:
                return b""  # the reader comes again, and is told what is the matter
            if ending is not None and not content:
                return _DELETED if ending is Ending.DELETED else b""
            if not content:
                done, _ = await asyncio.wait(
                    (gone, news), timeout=HEARTBEAT_SECONDS, return_when=asyncio.FIRST_COMPLETED
                )
                content = b"" if done else KEEPALIVE_COMMENT
        return b""

    async def _next(self, feed: Feed) -> bytes:
        """Return what follows, as one piece."""
        frames = feed.after(self._after)
        if frames is None:
            frames = await self._feeds.missed(self._number, self._after)
        if frames:
            self._after = frames[-1].moment
        return b"".join(frame.content for frame in frames)


async def _disconnected(receive: Receive) -> None:
    while (await receive())["type"] != "http.disconnect":
        pass


_DELETED = format_sse_event(event="deleted", data_str="{}")
