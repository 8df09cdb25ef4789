"""Look at a map: a picture of its zones and its graph, as the paper's figure 3."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query, Request, Response

from semtopo.render.drawing import DEFAULT_LAYERS, SIDE_MAX, SIDE_MIN, Layer, read_layers
from service.errors import InvalidRequestError
from service.painting import Form
from service.parameters import AtStep, IfNoneMatch, SessionId, ZoneName, pictures_of
from service.pictures import PictureRequest
from service.replies import unless_known
from service.schemas.answers import Radius
from service.schemas.problems import problems

router = APIRouter(
    prefix="/sessions/{session_id}", responses=problems(401, 404, 409, 413, 422, 503), tags=["map"]
)

Side = Annotated[
    int | None,
    Query(ge=SIDE_MIN, le=SIDE_MAX, description="pixels; what the map needs if left out"),
]
Layers = Annotated[
    str,
    Query(
        max_length=200,
        description=f"with commas between: {', '.join(Layer)}; all but frontiers if left out",
    ),
]
From = Annotated[ZoneName | None, Query(alias="from", description="where a route to draw begins")]
To = Annotated[ZoneName | None, Query(alias="to", description="where it ends")]

Robot = Annotated[
    Radius | None, Query(description="of the robot, in m: the route is drawn as a path for it")
]

_ALL = ",".join(sorted(DEFAULT_LAYERS))


class SvgBytes(Response):
    """A picture as text."""

    media_type = "image/svg+xml"


class PngBytes(Response):
    """A picture as pixels."""

    media_type = "image/png"


_WRITTEN: dict[Form, type[Response]] = {Form.SVG: SvgBytes, Form.PNG: PngBytes}


@router.get(
    "/map.{form}",
    response_class=Response,
    responses={
        200: {"content": {kind.media_type: {} for kind in _WRITTEN.values()}},
        304: {"description": "unchanged"},
    },
)
async def draw_map(  # noqa: PLR0913 -- one for each parameter
    request: Request,
    session_id: SessionId,
    form: Form,
    *,
    if_none_match: IfNoneMatch = None,
    at: AtStep = None,
    width: Side = None,
    height: Side = None,
    layers: Layers = _ALL,
    source: From = None,
    target: To = None,
    radius: Robot = None,
) -> Response:
    """Draw a map, now or as of a step, as SVG or PNG; with `from` and `to`, the route between."""
    if (source is None) != (target is None):
        raise InvalidRequestError("a route needs both from and to")
    asked = PictureRequest(
        form=form, at=at, width=width, height=height, layers=read_layers(layers),
        radius=radius, route=None if source is None or target is None else (source, target),
    )  # fmt: skip
    body = await pictures_of(request).picture(session_id, asked)
    return unless_known(_WRITTEN[form], body, if_none_match)
