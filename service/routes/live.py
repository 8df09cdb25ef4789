"""What a page needs to follow a robot: events as they happen, and where it was and what it saw."""

from __future__ import annotations

from functools import partial
from typing import Annotated

import orjson
from fastapi import APIRouter, Header, Query, Request, Response

from semtopo import UnknownStepError, WorldDocument
from service import store
from service.errors import NoWorldError, UnknownSessionError
from service.parameters import (
    AfterStep,
    AtStep,
    IfNoneMatch,
    SessionId,
    feeds_of,
    maps_of,
    sessions_of,
)
from service.replies import JsonBytes, unless_known
from service.schemas.live import SightAnswer, TrailAnswer
from service.schemas.problems import problems
from service.stream import EventStream, event_id

router = APIRouter(responses=problems(401, 413, 422, 503), tags=["live"])

LastEventId = Annotated[
    str | None,
    Header(alias="Last-Event-ID", max_length=64, description="go on after this event"),
]
TrailLimit = Annotated[int, Query(ge=1, le=10_000)]


@router.get(
    "/sessions/{session_id}/events",
    status_code=200,  # for OpenAPI, which else asks the class
    response_class=EventStream,
    responses={200: {"description": "events `step`, `change` and `deleted`"}, **problems(404)},
)
async def follow(
    request: Request, session_id: SessionId, last_event_id: LastEventId = None
) -> Response:
    """Follow a session: all that comes after the event named by Last-Event-ID, else after now."""
    after, feeds = event_id(last_event_id), feeds_of(request)
    hot = await sessions_of(request).find(session_id)
    newest = await feeds.newest(hot.row.number)
    if newest is None:
        raise UnknownSessionError("there is no session of that id")
    if after is not None and (after.seq > newest.seq or after.revision > newest.revision):
        raise UnknownStepError(f"the last step of this session is {newest.seq}")
    return EventStream(feeds, hot.row.number, newest, newest if after is None else after)


@router.get("/sessions/{session_id}/trail", response_model=TrailAnswer, responses=problems(404))
async def read_trail(
    request: Request, session_id: SessionId, after: AfterStep = 0, limit: TrailLimit = 10_000
) -> Response:
    """Read where the robot was at each step, and which steps found something."""
    sessions = sessions_of(request)
    hot = await sessions.find(session_id)
    query = partial(store.trail_after, session=hot.row.number, seq=after, limit=limit + 1)
    poses, changes = await sessions.read(query)
    last = after + min(limit, len(poses))
    document = {
        "first": after + 1,
        "poses": poses[:limit],
        "changes": [one for one in changes if one["seq"] <= last],
        "next": last if len(poses) > limit else None,
    }
    return JsonBytes(orjson.dumps(document))


@router.get(
    "/sessions/{session_id}/scan",
    response_model=SightAnswer,
    responses={304: {"description": "unchanged"}, **problems(404)},
)
async def read_scan(
    request: Request, session_id: SessionId, if_none_match: IfNoneMatch = None, at: AtStep = None
) -> Response:
    """Read what the robot saw at a step: where its beams ended, and why."""
    body = await maps_of(request).sight(session_id, at)
    return unless_known(JsonBytes, body, if_none_match)


@router.get(
    "/sessions/{session_id}/world",
    response_model=WorldDocument,
    responses=problems(404, 409),
)
async def read_world(request: Request, session_id: SessionId) -> Response:
    """Read the world that the session's simulated sensor senses."""
    world = (await sessions_of(request).find(session_id)).row.world
    if world is None:
        raise NoWorldError("this session has no world: its robot brings its own scans")
    return JsonBytes(world.encode())
