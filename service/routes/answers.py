"""Ask for the way."""

from __future__ import annotations

from asyncio import to_thread
from typing import Annotated

import orjson
from fastapi import APIRouter, Query, Request, Response

from semtopo import Atlas, find_routes
from semtopo.codec import route_document
from service.parameters import SessionId, maps_of
from service.replies import JsonBytes
from service.routing import route_request
from service.schemas.answers import RouteQuery, RoutesAnswer
from service.schemas.problems import problems

router = APIRouter(tags=["answers"], responses=problems(401, 413, 422, 503))


@router.get(
    "/sessions/{session_id}/route",
    response_model=RoutesAnswer,
    responses=problems(404, 409),
)
async def read_route(
    request: Request, session_id: SessionId, asked: Annotated[RouteQuery, Query()]
) -> Response:
    """Find the way that costs least, and others; with a radius, with a path for the robot."""
    atlas = await maps_of(request).atlas(session_id, asked.at)
    return JsonBytes(await to_thread(_found, atlas, asked))


def _found(atlas: Atlas, asked: RouteQuery) -> bytes:
    best, *others = map(route_document, find_routes(atlas, route_request(atlas, asked)))
    more = {} if asked.alternatives == 1 else {"alternatives": others}
    return orjson.dumps({**best, **more})
