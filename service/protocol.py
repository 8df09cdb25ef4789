"""Close connections that send too slowly, which uvicorn by itself keeps for ever.

A request must have arrived whole a given time after its first byte, and a new connection must begin
one in that time; between requests uvicorn's own keep-alive limit holds. So a client that trickles
headers or body, or says nothing, holds a connection for a bounded time only.
"""

from __future__ import annotations

import asyncio
from typing import Any

from uvicorn.protocols.http.httptools_impl import HttpToolsProtocol

REQUEST_SECONDS = 10.0
"""For all of a request to arrive: 4 MiB take 4 s on a link of 10 Mbit/s."""

HEAD_BYTES_MAX = 2**16
"""For request line and headers; they would else be gathered without bound."""


class PatientProtocol(HttpToolsProtocol):
    """HTTP/1.1 with an end to patience."""

    def __init__(self, *given: Any, **more: Any) -> None:  # noqa: ANN401 -- as uvicorn calls it
        """Begin without a deadline."""
        super().__init__(*given, **more)
        self._deadline: asyncio.TimerHandle | None = None
        self._head_bytes = 0
        self._in_head = True

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Wait for the first request."""
        super().connection_made(transport)
        self._start_deadline()

    def connection_lost(self, exc: Exception | None) -> None:
        """Forget the deadline."""
        self._stop_deadline()
        super().connection_lost(exc)

    def data_received(self, data: bytes) -> None:
        """Refuse a head beyond its bound."""
        if self._in_head:
            self._head_bytes += len(data)
        super().data_received(data)
        if self._in_head and self._head_bytes > HEAD_BYTES_MAX and not self.transport.is_closing():
            self.send_400_response("Request head too large.")

    def on_message_begin(self) -> None:
        """Start the deadline with the first byte of a request."""
        self._in_head = True
        if self._deadline is None:
            self._start_deadline()
        super().on_message_begin()

    def on_headers_complete(self) -> None:
        """Begin to count anew for the next head."""
        self._in_head = False
        self._head_bytes = 0
        super().on_headers_complete()

    def on_message_complete(self) -> None:
        """End the deadline: the request is there, the rest is for the server to do."""
        self._in_head = True
        self._stop_deadline()
        super().on_message_complete()

    def _start_deadline(self) -> None:
        self._deadline = self.loop.call_later(REQUEST_SECONDS, self._give_up)

    def _stop_deadline(self) -> None:
        if self._deadline is not None:
            self._deadline.cancel()
            self._deadline = None

    def _give_up(self) -> None:
        """Close the connection; nothing of an unfinished request is acted on."""
        self._deadline = None
        self.transport.abort()
