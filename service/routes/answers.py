"""Ask for the way."""

from __future__ import annotations

from typing import Annotated

import orjson
from fastapi import APIRouter, Query, Request, Response

from semtopo.codec import route_document
from service.parameters import SessionId, ZoneName, maps_of
from service.replies import JsonBytes
from service.schemas.answers import RouteAnswer
from service.schemas.problems import problems

router = APIRouter(tags=["answers"], responses=problems(401, 413, 422, 503))


@router.get(
    "/sessions/{session_id}/route",
    response_model=RouteAnswer,
    responses=problems(404, 409),
)
async def read_route(
    request: Request,
    session_id: SessionId,
    source: Annotated[ZoneName, Query(alias="from")],
    target: Annotated[ZoneName, Query(alias="to")],
) -> Response:
    """Find the route with the fewest passages, then the shortest between passage points."""
    route = await maps_of(request).route(session_id, source, target)
    return JsonBytes(orjson.dumps(route_document(route)))
