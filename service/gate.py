"""Let in only who brings an API key, and each only to the sessions made with that key.

All about keys in requests is here: where none are asked for, this gate is not built in. Behind it,
a session of somebody else's is as if it did not exist.
"""

from __future__ import annotations

import re

from fastapi import FastAPI
from starlette.types import ASGIApp, Receive, Scope, Send

from service.errors import UnauthorizedError, UnknownSessionError
from service.headers import find_header
from service.problems import problem_of
from service.sessions import Sessions

_GUARDED = re.compile(r"/sessions(?:/(?P<id>[^/]*)(?:/.*)?)?/?", re.DOTALL)


class KeyGate:
    """ASGI middleware that asks for `Authorization: Bearer KEY`; state `owner` is the key's number.

    What tells nothing of sessions, such as /healthz and /docs, is open to all.
    """

    def __init__(self, app: ASGIApp, service: FastAPI) -> None:
        """Guard an application; `service` has the sessions."""
        self._app = app
        self._service = service

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Let a request through, or refuse it."""
        found = _GUARDED.fullmatch(scope["path"]) if scope["type"] == "http" else None
        if found is not None:
            try:
                owner = await self._admitted(scope, found["id"])
            except (UnauthorizedError, UnknownSessionError) as error:
                await problem_of(error)(scope, receive, send)
                return
            scope.setdefault("state", {})["owner"] = owner
        await self._app(scope, receive, send)

    async def _admitted(self, scope: Scope, session_id: str | None) -> int:
        """Return the number of the key that was sent, if it opens the session."""
        scheme, _, key = (find_header(scope, b"authorization") or "").partition(" ")
        if scheme.lower() != "bearer":
            raise UnauthorizedError("send an API key: Authorization: Bearer KEY")
        sessions: Sessions = self._service.state.sessions
        owner = await sessions.authenticate(key.strip())
        if session_id and (await sessions.find(session_id)).row.owner != owner:
            raise UnknownSessionError("there is no session of that id")
        return owner
