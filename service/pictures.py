"""Draw maps: as they are and as they were, with the robot's trail, and a route where one is asked.

What is drawn once is kept in memory, for as long as the map stays as it is.
"""

from __future__ import annotations

import asyncio
from dataclasses import dataclass
from functools import partial

from semtopo import Atlas, MapState, find_routes
from semtopo.render import render
from semtopo.render.drawing import DEFAULT_LAYERS, Drawing, DrawnRoute, Layer, trail_stride
from service import store
from service.maps import Body, Maps, Moment
from service.painter import Painter
from service.painting import Form
from service.routing import route_request
from service.schemas.answers import RouteQuery
from service.sessions import Sessions


@dataclass(frozen=True, slots=True, kw_only=True)
class PictureRequest:
    """Asks for a picture of a map as of step `at`, and of a route in it, if any."""

    form: Form
    at: int | None = None
    width: int | None = None
    height: int | None = None
    layers: frozenset[Layer] = DEFAULT_LAYERS
    route: RouteQuery | None = None

    @property
    def kind(self) -> str:
        """What tells its body from those of other requests for the same map."""
        size = f"{self.width} {self.height}"
        return f"picture {self.form} {size} {sorted(self.layers)} {self.route}"


class Pictures:
    """Pictures of the maps of all sessions."""

    def __init__(self, sessions: Sessions, maps: Maps) -> None:
        """Begin with nothing drawn."""
        self._sessions = sessions
        self._maps = maps
        self._painter = Painter()

    async def picture(self, session_id: str, asked: PictureRequest) -> Body:
        """Return a picture of a map.

        Raises
        ------
        InvalidOptionError
            Its size is out of range.
        UnknownStepError, UnknownZoneError, NoRouteError
            The map or the route that is asked for is not there.
        BusyError, PictureError
            Too many pictures are asked for, or this one takes too long.
        """
        return await self._maps.body(
            session_id,
            asked.at,
            asked.kind,
            lambda moment, state: self._drawn(moment, state, asked),
        )

    async def _drawn(self, moment: Moment, state: MapState, asked: PictureRequest) -> bytes:
        """Return the bytes of a picture."""
        query = partial(
            store.list_positions,
            session=moment.hot.row.number, seq=state.seq, stride=trail_stride(state.seq),
        )  # fmt: skip
        drawing = Drawing(
            trail=await self._sessions.read(query),
            layers=asked.layers, width=asked.width, height=asked.height,
            route=await self._route(moment.atlas(state), asked.route),
        )  # fmt: skip
        svg = await asyncio.to_thread(render, state, drawing)
        return svg.encode() if asked.form is Form.SVG else await self._painter.png_of(svg)

    async def _route(self, atlas: Atlas, asked: RouteQuery | None) -> DrawnRoute | None:
        """Return the route that is to be drawn, if any is; with a radius, its path."""
        return None if asked is None else await asyncio.to_thread(_drawn_route, atlas, asked)


def _drawn_route(atlas: Atlas, query: RouteQuery) -> DrawnRoute:
    found = find_routes(atlas, route_request(atlas, query))[0]
    line = found.points if found.path is None else found.path.points
    return DrawnRoute(line, frozenset(passage.key for passage in found.passages))
