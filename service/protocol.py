"""Close connections that send or read too slowly, which uvicorn by itself keeps for ever.

A request must have arrived whole a given time after its first byte, and a new connection must begin
one in that time; between requests uvicorn's own keep-alive limit holds. So a client that trickles
headers or body, or says nothing, holds a connection for a bounded time only; and so does one that
does not take its answer.
"""

from __future__ import annotations

import asyncio
from http import HTTPStatus
from math import inf
from typing import Any

from fastapi import FastAPI
from uvicorn.protocols.http.httptools_impl import HttpToolsProtocol

from service.corked import Corked
from service.problems import Problem

REQUEST_SECONDS = 10.0
"""For all of a request to arrive: 1 MiB takes 1 s on a link of 10 Mbit/s."""

ANSWER_SECONDS = 30.0
"""For an answer that piles up here to flow off: some 64 KiB."""

_MALFORMED, _BUSY = 400, 503

HEAD_BYTES_MAX = 2**16
"""For request line and headers; they would else be gathered without bound."""


class PatientProtocol(HttpToolsProtocol):
    """HTTP/1.1 with an end to patience."""

    def __init__(self, *given: Any, **more: Any) -> None:  # noqa: ANN401 -- as uvicorn calls it
        """Begin without deadlines."""
        super().__init__(*given, **more)
        self._deadline: asyncio.TimerHandle | None = None
        self._answer_deadline: asyncio.TimerHandle | None = None
        self._head_bytes = 0
        self._in_head = True
        self._arriving = False
        self._unanswered = 0
        app = self.config.app
        self._connections_max = (
            app.state.settings.connections_max if isinstance(app, FastAPI) else inf
        )

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Wait for the first request."""
        super().connection_made(Corked(transport))
        if len(self.connections) > self._connections_max:
            self._refuse(_BUSY, "busy", "too many connections are open")
        else:
            self._start_deadline()

    def connection_lost(self, exc: Exception | None) -> None:
        """Forget the deadlines."""
        self._stop_deadline()
        self._stop_answer_deadline()
        super().connection_lost(exc)

    def send_400_response(self, msg: str) -> None:
        """Say that a request is not HTTP, as a problem like all others, and close."""
        self._refuse(_MALFORMED, "malformed_request", msg)

    def _refuse(self, status: int, code: str, detail: str) -> None:
        """Answer with a problem, and close the connection."""
        problem = Problem(status, code, detail, {"Retry-After": "1"} if status == _BUSY else None)
        head = [*problem.raw_headers, (b"connection", b"close")]
        lines = [
            f"HTTP/1.1 {status} {HTTPStatus(status).phrase}\r\n".encode(),
            *(b"%b: %b\r\n" % pair for pair in head),
            b"\r\n",
        ]
        self.transport.write(b"".join(lines) + bytes(problem.body))
        self.transport.close()

    def data_received(self, data: bytes) -> None:
        """Start the deadline with the first byte, and refuse a head beyond its bound."""
        if self.transport.is_closing():
            return
        if self._deadline is None:
            self._start_deadline()
        if self._in_head:
            self._head_bytes += len(data)
        super().data_received(data)
        if self._in_head and self._head_bytes > HEAD_BYTES_MAX and not self.transport.is_closing():
            self.send_400_response("Request head too large.")

    def on_message_begin(self) -> None:
        """Expect the rest of a request in time, also where it came with the end of another."""
        self._in_head = self._arriving = True
        if self._deadline is None:
            self._start_deadline()
        super().on_message_begin()

    def on_headers_complete(self) -> None:
        """Begin to count anew for the next head."""
        self._in_head = False
        self._head_bytes = 0
        self._unanswered += 1
        super().on_headers_complete()

    def on_message_complete(self) -> None:
        """End the deadline: the request is there, the rest is for the server to do."""
        self._in_head, self._arriving = True, False
        self._stop_deadline()
        super().on_message_complete()

    def on_response_complete(self) -> None:
        """Start a deadline for the client to take the rest of an answer, if there is one."""
        self._unanswered -= 1
        super().on_response_complete()
        if self.transport.get_write_buffer_size() > 0:
            self._start_answer_deadline()

    def pause_writing(self) -> None:
        """Start a deadline for the client to take what was written."""
        super().pause_writing()
        self._start_answer_deadline()

    def resume_writing(self) -> None:
        """End that deadline."""
        self._stop_answer_deadline()
        super().resume_writing()

    def _start_deadline(self) -> None:
        self._deadline = self.loop.call_later(REQUEST_SECONDS, self._give_up)

    def _stop_deadline(self) -> None:
        if self._deadline is not None:
            self._deadline.cancel()
            self._deadline = None

    def _start_answer_deadline(self) -> None:
        self._stop_answer_deadline()
        self._answer_deadline = self.loop.call_later(ANSWER_SECONDS, self._give_up_answer)

    def _stop_answer_deadline(self) -> None:
        if self._answer_deadline is not None:
            self._answer_deadline.cancel()
            self._answer_deadline = None

    def _give_up_answer(self) -> None:
        """Close the connection, if there is still something that the client did not take."""
        self._answer_deadline = None
        if self.transport.get_write_buffer_size() > 0:
            self.transport.abort()

    def _give_up(self) -> None:
        """Close the connection, unless it waits for an answer; nothing unfinished is acted on."""
        self._deadline = None
        if self._arriving or not self._unanswered:
            self.transport.abort()
        else:
            self._start_deadline()  # there were stray bytes after the request
