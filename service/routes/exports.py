"""Take a map away in the format of another program."""

from __future__ import annotations

from functools import partial
from typing import Annotated

from fastapi import APIRouter, Query, Request, Response

from semtopo import Atlas
from semtopo.exports import EXPORTS, RADIUS_MAX, Format
from semtopo.exports.chart import Chart
from semtopo.exports.geojson import border_features
from service.parameters import AtStep, IfNoneMatch, SessionId, maps_of
from service.replies import unless_known
from service.schemas.problems import problems

router = APIRouter(
    prefix="/sessions/{session_id}", responses=problems(401, 404, 409, 413, 422, 503), tags=["map"]
)

Radius = Annotated[
    float,
    Query(ge=0, le=RADIUS_MAX, allow_inf_nan=False, description="of the robot, in m; for `nav2`"),
]

WORK_MAX = 100_000
"""To find ways, as `Chart` counts it: some 10 s of one processor, 120 ragged rooms."""

_MEDIA = sorted({export.media_type for export in EXPORTS.values()})


@router.get(
    "/export/{form}",
    response_class=Response,
    responses={
        200: {"content": {media_type: {} for media_type in _MEDIA}},
        304: {"description": "unchanged"},
    },
)
async def export_map(
    request: Request,
    session_id: SessionId,
    form: Format,
    *,
    if_none_match: IfNoneMatch = None,
    at: AtStep = None,
    radius: Radius = 0.0,
) -> Response:
    """Write a map, now or as of a step, for another program."""
    build = partial(_written, form=form, radius=radius)
    body = await maps_of(request).view(session_id, at, f"export {form} {radius}", build)
    return unless_known(partial(Response, media_type=EXPORTS[form].media_type), body, if_none_match)


def _written(atlas: Atlas, form: Format, radius: float) -> bytes:
    return EXPORTS[form].write(Chart(atlas.state, border_features(atlas.state), radius, WORK_MAX))
