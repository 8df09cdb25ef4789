"""The HTTP interface to what can be seen of a map: each is drawn or written by the library."""

from __future__ import annotations

from typing import Any

from fastapi import APIRouter, Request, Response

from semtopo.exports.geojson import borders_body, doorways_body
from service.arguments import DirectRoute
from service.maps import taken
from service.parameters import (
    AtStep,
    BoundingBox,
    IfNoneMatch,
    SessionId,
    SinceStep,
    Tolerance,
    bounding_box,
    maps_of,
)
from service.replies import GeoJsonBytes, unless_known
from service.schemas.maps import BordersAnswer, DoorwaysAnswer
from service.schemas.problems import problems

router = APIRouter(
    prefix="/sessions/{session_id}",
    responses=problems(401, 404, 413, 422, 503),
    tags=["map"],
    route_class=DirectRoute,
)

UNCHANGED: dict[int | str, dict[str, Any]] = {304: {"description": "unchanged"}}


@router.get(
    "/borders",
    response_model=BordersAnswer,
    response_class=GeoJsonBytes,
    responses=UNCHANGED,
)
async def read_borders(  # noqa: PLR0913 -- one for each parameter of HTTP
    request: Request,
    session_id: SessionId,
    if_none_match: IfNoneMatch = None,
    box: BoundingBox = None,
    at: AtStep = None,
    *,
    tolerance: Tolerance = 0.0,
    since: SinceStep = None,
) -> Response:
    """Read the borders of all zones as GeoJSON lines: walls, passages and frontiers (`free`)."""
    chosen = bounding_box(box)
    body = await maps_of(request).view(
        session_id, at, f"borders {chosen} {tolerance} {since}",
        lambda atlas: borders_body(
            atlas.state, chosen, tolerance, taken(since, atlas.state.seq)
        ),
    )  # fmt: skip
    return unless_known(GeoJsonBytes, body, if_none_match)


@router.get(
    "/doorways",
    response_model=DoorwaysAnswer,
    response_class=GeoJsonBytes,
    responses=UNCHANGED,
)
async def read_doorways(  # noqa: PLR0913 -- one for each parameter of HTTP
    request: Request,
    session_id: SessionId,
    if_none_match: IfNoneMatch = None,
    box: BoundingBox = None,
    at: AtStep = None,
    *,
    tolerance: Tolerance = 0.0,
    since: SinceStep = None,
) -> Response:
    """Read the doorways as GeoJSON: the free ground between two zones, which belongs to neither."""
    chosen = bounding_box(box)
    body = await maps_of(request).view(
        session_id, at, f"doorways {chosen} {tolerance} {since}",
        lambda atlas: doorways_body(
            atlas.state, chosen, tolerance, taken(since, atlas.state.seq)
        ),
    )  # fmt: skip
    return unless_known(GeoJsonBytes, body, if_none_match)
