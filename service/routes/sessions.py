"""Begin, list and delete sessions."""

from __future__ import annotations

import hashlib
import secrets
from asyncio import to_thread
from importlib.metadata import version
from typing import Annotated, Any, Literal

import orjson
from fastapi import APIRouter, Query, Request, Response

from service.arguments import DirectRoute
from service.clock import now
from service.hot import HotSession
from service.parameters import (
    IdempotencyKey,
    Limit,
    SessionId,
    idempotency_key,
    owner_of,
    sessions_of,
)
from service.replies import JsonBytes
from service.schemas.problems import problems
from service.schemas.sessions import SessionAnswer, SessionRequest, SessionsAnswer
from service.store import CreationKey, NewSession, SessionHead

router = APIRouter(
    tags=["sessions"], responses=problems(401, 413, 422, 503), route_class=DirectRoute
)


@router.post(
    "/sessions",
    status_code=201,
    response_model=SessionAnswer,
    responses=problems(400, 415),
)
async def create_session(
    request: Request, document: SessionRequest, key: IdempotencyKey = None
) -> Response:
    """Begin a session with an empty map; a retry gets the same session again."""
    given = idempotency_key(key)
    # in a thread, since a large world takes some time to be checked
    new = await to_thread(new_session, secrets.token_hex(8), document, owner_of(request))
    if given is None:
        hot = await sessions_of(request).create(new)
    else:
        fingerprint = hashlib.sha256(document.model_dump_json().encode()).digest()
        hot = await sessions_of(request).create_once(new, CreationKey(given, fingerprint))
    headers = {"Location": f"/sessions/{hot.row.id}"}
    if hot.row.id != new.id:
        headers["Idempotency-Replayed"] = "true"
    return JsonBytes(orjson.dumps({**_session(hot), "seq": 0}), 201, headers)


@router.get("/sessions", response_model=SessionsAnswer)
async def list_sessions(
    request: Request,
    cursor: Annotated[str, Query(pattern=r"^\d{1,18}$")] = "0",
    limit: Limit = 100,
    order: Literal["oldest", "newest"] = "oldest",
) -> Response:
    """List sessions, oldest or newest first; a cursor is of the same order."""
    rows = await sessions_of(request).page(
        owner_of(request), int(cursor), limit + 1, newest=order == "newest"
    )
    page = rows[:limit]
    following = str(page[-1].number) if len(rows) > limit else None
    listed = [_listed(row) for row in page]
    return JsonBytes(orjson.dumps({"sessions": listed, "next": following}))


@router.get(
    "/sessions/{session_id}",
    response_model=SessionAnswer,
    responses=problems(404),
)
async def read_session(request: Request, session_id: SessionId) -> Response:
    """Tell about a session."""
    return JsonBytes(orjson.dumps(_session(await sessions_of(request).find(session_id))))


@router.delete("/sessions/{session_id}", status_code=204, responses=problems(404))
async def delete_session(request: Request, session_id: SessionId) -> Response:
    """Delete a session, its map and its log."""
    await sessions_of(request).delete(session_id)
    return Response(status_code=204)


def new_session(session_id: str, request: SessionRequest, owner: int | None = None) -> NewSession:
    """Return a session that can be stored; raises InvalidWorldError for an impossible world."""
    if request.world is not None:
        request.world.value()
    return NewSession(
        id=session_id,
        name=request.name or (request.world.name if request.world else "") or session_id,
        created_at=now(),
        world=request.world.model_dump_json() if request.world else None,
        sensor=request.sensor.model_dump_json(),
        mapping=request.mapping.model_dump_json(),
        engine=version("semtopo"),
        owner=owner,
    )


def _session(hot: HotSession) -> dict[str, Any]:
    row, world = hot.row, hot.world
    return {
        **_listed(row),
        "seq": hot.seq,
        "sensor": orjson.Fragment(row.sensor),
        "mapping": orjson.Fragment(row.mapping),
        "world": None if world is None else {"name": world.name, "zones": len(world.zones)},
    }


def _listed(row: SessionHead) -> dict[str, Any]:
    return {"id": row.id, "name": row.name, "created_at": row.created_at, "seq": row.version}
