"""Refuse request bodies that are too large, before they fill the memory.

Starlette has a limit of its own, but answers in plain text where the length is declared.
"""

from __future__ import annotations

from starlette.datastructures import Headers
from starlette.exceptions import HTTPException
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from service.errors import Problem

_TOO_LARGE = 413


class BodyLimit:
    """ASGI middleware: a body of more than `bytes_max` bytes gets a problem with status 413."""

    def __init__(self, app: ASGIApp, bytes_max: int) -> None:
        """Wrap an application."""
        self._app = app
        self._bytes_max = bytes_max

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Judge by the declared length, and by the bytes that come in."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
        elif int(Headers(scope=scope).get("content-length", 0)) > self._bytes_max:
            problem = Problem(_TOO_LARGE, "body_too_large", "body too large")
            await problem(scope, receive, send)
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
