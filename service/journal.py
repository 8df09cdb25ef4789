"""Write a line for every request, and count it: what was asked, by whom, how it ended, how long.

A request has an id, its own (`X-Request-ID`) or a new one, which goes out with the answer and is in
every line that is written on its behalf. Bodies, queries and keys are never written.
"""

from __future__ import annotations

import logging
import re
import secrets
import sys
from contextvars import ContextVar
from datetime import UTC, datetime
from time import perf_counter
from typing import Any, Literal

import orjson
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from service.clock import written
from service.headers import find_header
from service.metrics import Metrics

_log = logging.getLogger(__name__)

_ID = re.compile(r"[A-Za-z0-9._-]{1,128}")

_request_id: ContextVar[str | None] = ContextVar("request_id", default=None)

_FAULT = 500


class JsonLines(logging.Formatter):
    """One JSON object a line."""

    def format(self, record: logging.LogRecord) -> str:
        """Return a record with its time, its request's id and what else it tells."""
        line: dict[str, Any] = {
            "time": written(datetime.fromtimestamp(record.created, UTC)),
            "level": record.levelname.lower(),
            "logger": record.name,
            "message": record.getMessage(),
            "request_id": _request_id.get(),
            **getattr(record, "told", {}),
        }
        if record.exc_info:
            line["exception"] = self.formatException(record.exc_info)
        return orjson.dumps(line).decode()


class PlainLines(logging.Formatter):
    """The same in words."""

    def __init__(self) -> None:
        """Begin each line with the time."""
        super().__init__("%(asctime)s %(levelname)s %(name)s: %(message)s")

    def format(self, record: logging.LogRecord) -> str:
        """Return a record with what else it tells."""
        told = {"request_id": _request_id.get(), **getattr(record, "told", {})}
        more = " ".join(f"{name}={it}" for name, it in told.items() if it is not None)
        return f"{super().format(record)} {more}".rstrip()


def start_log(kind: Literal["json", "text"]) -> None:
    """Let everything that is logged from now on go to stderr."""
    handler = logging.StreamHandler(sys.stderr)
    handler.setFormatter(JsonLines() if kind == "json" else PlainLines())
    logging.basicConfig(level=logging.INFO, handlers=[handler], force=True)


class Journal:
    """ASGI middleware that counts responses, and writes a line about each."""

    def __init__(self, app: ASGIApp, metrics: Metrics) -> None:
        """Wrap an application."""
        self._app = app
        self._metrics = metrics

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass everything on, but for the id that an answer gets."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        begun, status = perf_counter(), _FAULT  # a fault is answered further out
        request_id = _id_of(scope)
        _request_id.set(request_id)

        async def noted(message: Message) -> None:
            nonlocal status
            if message["type"] == "http.response.start":
                status = message["status"]
                message["headers"] = [*message["headers"], (b"x-request-id", request_id.encode())]
            await send(message)

        try:
            await self._app(scope, receive, noted)
        finally:
            self._metrics.count_response(status)
            _write(scope, status, 1000 * (perf_counter() - begun))


def _id_of(scope: Scope) -> str:
    given = find_header(scope, b"x-request-id")
    if given is not None and _ID.fullmatch(given):
        return given
    return secrets.token_hex(8)


def _write(scope: Scope, status: int, milliseconds: float) -> None:
    """Write about a request; an address that no route has is not repeated."""
    if not _log.isEnabledFor(logging.INFO):
        return
    told = {
        "method": scope["method"],
        "path": getattr(scope.get("route"), "path", None),
        "status": status,
        "ms": round(milliseconds, 3),
        "session": scope.get("path_params", {}).get("session_id"),
    }
    _log.info("request", extra={"told": told})
