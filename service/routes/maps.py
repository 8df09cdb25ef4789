"""Read the graph and the zones."""

from __future__ import annotations

from fastapi import APIRouter, Request, Response

from semtopo.codec import zones_body
from service.arguments import DirectRoute
from service.maps import taken
from service.parameters import (
    AtStep,
    BoundingBox,
    IfNoneMatch,
    SessionId,
    SinceStep,
    bounding_box,
    maps_of,
)
from service.replies import GeoJsonBytes, JsonBytes, unless_known
from service.schemas.maps import GraphAnswer, ZonesAnswer
from service.schemas.problems import problems

router = APIRouter(tags=["map"], responses=problems(401, 413, 422, 503), route_class=DirectRoute)


@router.get(
    "/sessions/{session_id}/graph",
    response_model=GraphAnswer,
    responses={304: {"description": "unchanged"}, **problems(404)},
)
async def read_graph(
    request: Request,
    session_id: SessionId,
    if_none_match: IfNoneMatch = None,
    at: AtStep = None,
    since: SinceStep = None,
) -> Response:
    """Read the topology graph, now or as of a step; or only what changed."""
    body = await maps_of(request).graph(session_id, at, since)
    return unless_known(JsonBytes, body, if_none_match)


@router.get(
    "/sessions/{session_id}/zones",
    response_model=ZonesAnswer,
    response_class=GeoJsonBytes,
    responses={304: {"description": "unchanged"}, **problems(404)},
)
async def read_zones(
    request: Request,
    session_id: SessionId,
    if_none_match: IfNoneMatch = None,
    box: BoundingBox = None,
    at: AtStep = None,
    *,
    since: SinceStep = None,
) -> Response:
    """Read the metric map as GeoJSON, now or as of a step; of all zones, or those in a box.

    With `since`: those that a later step changed. Names are no steps: events tell of them.
    """
    chosen = bounding_box(box)
    body = await maps_of(request).view(
        session_id, at, f"zones {chosen} {since}",
        lambda atlas: zones_body(
            atlas.state, chosen, atlas.notes, taken(since, atlas.state.seq)
        ),
    )  # fmt: skip
    return unless_known(GeoJsonBytes, body, if_none_match)
