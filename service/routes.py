"""The HTTP interface: every endpoint parses, calls one function of `sessions`, and answers."""

from __future__ import annotations

import hashlib
import secrets
from asyncio import to_thread
from functools import partial
from importlib.metadata import version
from typing import Annotated, Any

import orjson
from fastapi import APIRouter, Query, Request, Response

from semtopo.codec import answer_document, route_document, zones_body
from service import schemas
from service.hot import HotSession
from service.parameters import (
    AfterStep,
    AtStep,
    BoundingBox,
    IdempotencyKey,
    IfMatch,
    IfNoneMatch,
    Limit,
    SessionId,
    ZoneName,
    bounding_box,
    entity_tags,
    idempotency_key,
    owner_of,
    sessions_of,
)
from service.recording import StepRequest
from service.replies import GeoJsonBytes, JsonBytes, unless_known
from service.schemas import problems
from service.sessions import now
from service.store import LoggedStep, NewSession, SessionHead

router = APIRouter(responses=problems(401, 413, 422, 503))


@router.post(
    "/sessions",
    status_code=201,
    response_model=schemas.SessionAnswer,
    responses=problems(400, 415),
    tags=["sessions"],
)
async def create_session(request: Request, document: schemas.SessionRequest) -> Response:
    """Begin a session with an empty map."""
    # in a thread, since a large world takes some time to be checked
    new = await to_thread(new_session, secrets.token_hex(8), document, owner_of(request))
    hot = await sessions_of(request).create(new)
    headers = {"Location": f"/sessions/{hot.row.id}"}
    return JsonBytes(orjson.dumps(_session(hot)), 201, headers)


@router.get("/sessions", response_model=schemas.SessionsAnswer, tags=["sessions"])
async def list_sessions(
    request: Request,
    cursor: Annotated[str, Query(pattern=r"^\d{1,18}$")] = "0",
    limit: Limit = 100,
) -> Response:
    """List sessions, oldest first."""
    rows = await sessions_of(request).page(owner_of(request), int(cursor), limit + 1)
    page = rows[:limit]
    following = str(page[-1].number) if len(rows) > limit else None
    listed = [_listed(row) for row in page]
    return JsonBytes(orjson.dumps({"sessions": listed, "next": following}))


@router.get(
    "/sessions/{session_id}",
    response_model=schemas.SessionAnswer,
    responses=problems(404),
    tags=["sessions"],
)
async def read_session(request: Request, session_id: SessionId) -> Response:
    """Tell about a session."""
    return JsonBytes(orjson.dumps(_session(await sessions_of(request).find(session_id))))


@router.delete(
    "/sessions/{session_id}", status_code=204, responses=problems(404), tags=["sessions"]
)
async def delete_session(request: Request, session_id: SessionId) -> Response:
    """Delete a session, its map and its log."""
    await sessions_of(request).delete(session_id)
    return Response(status_code=204)


@router.post(
    "/sessions/{session_id}/step",
    status_code=201,
    response_model=schemas.StepAnswer,
    responses=problems(400, 404, 409, 412, 415),
    tags=["mapping"],
)
async def take_step(
    request: Request,
    session_id: SessionId,
    document: schemas.StepDocument,
    key: IdempotencyKey = None,
    if_match: IfMatch = None,
) -> Response:
    """Take a step. It is on disk before the answer leaves; a retry gets the first answer again."""
    asked = step_request(document, idempotency_key(key), entity_tags(if_match))
    body = await sessions_of(request).step(session_id, asked)
    headers = {"ETag": body.tag}
    if body.replayed:
        headers["Idempotency-Replayed"] = "true"
    return JsonBytes(body.content, 201, headers)


@router.get(
    "/sessions/{session_id}/steps",
    response_model=schemas.StepsAnswer,
    responses=problems(404),
    tags=["mapping"],
)
async def list_steps(
    request: Request, session_id: SessionId, after: AfterStep = 0, limit: Limit = 100
) -> Response:
    """Read the log: every step with its input and its answer, in order."""
    page, more = await sessions_of(request).steps(session_id, after, limit)
    following = page[-1].seq if more else None
    return JsonBytes(orjson.dumps({"steps": [_step(one) for one in page], "next": following}))


@router.get(
    "/sessions/{session_id}/graph",
    response_model=schemas.GraphAnswer,
    responses={304: {"description": "unchanged"}, **problems(404)},
    tags=["map"],
)
async def read_graph(
    request: Request, session_id: SessionId, if_none_match: IfNoneMatch = None, at: AtStep = None
) -> Response:
    """Read the topology graph, now or as of a step."""
    body = await sessions_of(request).graph(session_id, at)
    return unless_known(JsonBytes, body, if_none_match)


@router.get(
    "/sessions/{session_id}/zones",
    response_model=schemas.ZonesAnswer,
    response_class=GeoJsonBytes,
    responses={304: {"description": "unchanged"}, **problems(404)},
    tags=["map"],
)
async def read_zones(
    request: Request,
    session_id: SessionId,
    if_none_match: IfNoneMatch = None,
    box: BoundingBox = None,
    at: AtStep = None,
) -> Response:
    """Read the metric map as GeoJSON, now or as of a step; of all zones, or those in a box."""
    chosen = bounding_box(box)
    build = partial(zones_body, box=chosen)
    body = await sessions_of(request).view(session_id, at, f"zones {chosen}", build)
    return unless_known(GeoJsonBytes, body, if_none_match)


@router.get(
    "/sessions/{session_id}/route",
    response_model=schemas.RouteAnswer,
    responses=problems(404, 409),
    tags=["answers"],
)
async def read_route(
    request: Request,
    session_id: SessionId,
    source: Annotated[ZoneName, Query(alias="from")],
    target: Annotated[ZoneName, Query(alias="to")],
) -> Response:
    """Find the route with the fewest passages, then the shortest between passage points."""
    route = await sessions_of(request).route(session_id, source, target)
    return JsonBytes(orjson.dumps(route_document(route)))


@router.post(
    "/sessions/{session_id}/query",
    response_model=schemas.QueryAnswer,
    responses=problems(400, 404, 409, 415),
    tags=["answers"],
)
async def ask(request: Request, session_id: SessionId, question: schemas.QueryRequest) -> Response:
    """Answer a question in words, such as "path from corridor to C"."""
    answer = await sessions_of(request).answer(session_id, question.text)
    return JsonBytes(orjson.dumps(answer_document(answer)))


def new_session(
    session_id: str, request: schemas.SessionRequest, owner: int | None = None
) -> NewSession:
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


def step_request(
    document: schemas.StepDocument, key: str | None = None, tags: frozenset[str] | None = None
) -> StepRequest:
    """Return a step that can be taken; raises InvalidScanError for an impossible scan."""
    given = document.model_dump_json(include={"pose", "scan"}, exclude_none=True)
    return StepRequest(
        pose=document.pose.value(),
        seen=None if document.scan is None else document.scan.value(),
        input=given,
        fingerprint=hashlib.sha256(given.encode()).digest(),
        seq=document.seq,
        key=key,
        if_match=tags,
    )


def _session(hot: HotSession) -> dict[str, Any]:
    row, world = hot.row, hot.world
    return {
        **_listed(row),
        "sensor": orjson.Fragment(row.sensor),
        "mapping": orjson.Fragment(row.mapping),
        "world": None if world is None else {"name": world.name, "zones": len(world.zones)},
    }


def _listed(row: SessionHead) -> dict[str, Any]:
    return {"id": row.id, "name": row.name, "created_at": row.created_at, "seq": row.version}


def _step(logged: LoggedStep) -> dict[str, Any]:
    return {
        "seq": logged.seq,
        "taken_at": logged.taken_at,
        "input": orjson.Fragment(logged.input),
        "answer": orjson.Fragment(logged.answer),
    }
