"""Look at a map: a picture of its zones and its graph, as the paper's figure 3."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query, Request, Response

from semtopo.journey import STOPS_MAX
from semtopo.render.drawing import DEFAULT_LAYERS, SIDE_MAX, SIDE_MIN, Layer, read_layers
from service.errors import InvalidRequestError
from service.painting import Form
from service.parameters import AtStep, IfNoneMatch, SessionId, ZoneName, pictures_of
from service.pictures import PictureRequest
from service.replies import unless_known
from service.schemas.answers import AVOIDED_MAX, Avoided, Name, Radius, RouteQuery
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

Via = Annotated[
    tuple[Name, ...], Query(max_length=STOPS_MAX, description="zones that the route goes through")
]
Avoid = Annotated[
    tuple[Avoided, ...],
    Query(max_length=AVOIDED_MAX, description="zones it does not enter, and passages, as A->B"),
]
TwoWay = Annotated[bool, Query(description="it uses passages against their direction too")]

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
    via: Via = (),
    avoid: Avoid = (),
    two_way: TwoWay = False,
    radius: Robot = None,
) -> Response:
    """Draw a map, now or as of a step, as SVG or PNG; with `from` and `to`, the route between."""
    if (source is None) != (target is None):
        raise InvalidRequestError("a route needs both from and to")
    route = None if target is None else RouteQuery(
        source=source, target=target, via=via, avoid=avoid, two_way=two_way, radius=radius
    )  # fmt: skip
    asked = PictureRequest(
        form=form, at=at, width=width, height=height, layers=read_layers(layers), route=route
    )
    body = await pictures_of(request).picture(session_id, asked)
    return unless_known(_WRITTEN[form], body, if_none_match)
