"""Refuse request bodies that are too large, or not JSON, before they fill the memory.

Starlette has a limit of its own, but answers in plain text where the length is declared; and
FastAPI takes a body that does not say it is JSON for a text.
"""

from __future__ import annotations

import re

from starlette.exceptions import HTTPException
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from service.headers import find_header
from service.problems import Problem

_TOO_LARGE = 413
_UNSUPPORTED = 415
_JSON = re.compile(r"application/([^;\s]+\+)?json\s*(;.*)?", re.IGNORECASE)


class BodyLimit:
    """ASGI middleware: a body of more than `bytes_max` bytes, or of another type, is a problem."""

    def __init__(self, app: ASGIApp, bytes_max: int) -> None:
        """Wrap an application."""
        self._app = app
        self._bytes_max = bytes_max

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Judge by what is declared, and by the bytes that come in."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        length = int(find_header(scope, b"content-length") or 0)
        if length > self._bytes_max:
            problem = Problem(_TOO_LARGE, "body_too_large", "body too large")
            await problem(scope, receive, send)
        elif scope["method"] in {"POST", "PUT"} and not _is_json(scope, length):
            detail = "send JSON, with Content-Type: application/json"
            await Problem(_UNSUPPORTED, "unsupported_media_type", detail)(scope, receive, send)
        else:
            await self._app(scope, self._counted(receive), send)

    def _counted(self, receive: Receive) -> Receive:
        """Return `receive`, but that it raises when it has given too much."""
        taken = 0

        async def counted() -> Message:
            nonlocal taken
            message = await receive()
            taken += len(message.get("body", b""))
            if taken > self._bytes_max:
                raise HTTPException(_TOO_LARGE)
            return message

        return counted


def _is_json(scope: Scope, length: int) -> bool:
    """Say whether a body is declared as JSON, or there is none."""
    kind = find_header(scope, b"content-type")
    if kind is None:
        return length == 0 and find_header(scope, b"transfer-encoding") is None
    return _JSON.fullmatch(kind.strip()) is not None
