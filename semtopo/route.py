"""Routes through an atlas: which passages lead from one place to another, and what that costs.

In come an atlas and a request; out go routes, the best first. A zone is a region, not a point, so
distances do not add up from zone to zone: the search goes from passage to passage, and what counts
is the way between the two inside a zone.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import lru_cache
from itertools import islice, pairwise

import numpy as np

from semtopo.atlas import Atlas
from semtopo.doorways import Doorway
from semtopo.errors import (
    NotConnectedError,
    OutsideError,
    SemtopoError,
    TooNarrowError,
    UnknownZoneError,
)
from semtopo.finder import SHARED_MAX, Finder
from semtopo.freespace import FreeSpace, Path
from semtopo.geometry import joined
from semtopo.ground import ground_of
from semtopo.journey import Place, Route, RouteRequest
from semtopo.metric import MappedZone
from semtopo.network import CostModel
from semtopo.types import Point

SPACES_KEPT = 32
"""Free spaces in memory, of the latest paths; each is a triangulation of all zones on the way."""

__all__ = [
    "SHARED_MAX", "CostModel", "Place", "Route", "RouteRequest", "find_routes", "widest_place",
]  # fmt: skip


def find_routes(atlas: Atlas, request: RouteRequest) -> tuple[Route, ...]:
    """Return the best routes, the best first: at least one, at most `request.alternatives`.

    The first costs least of all; of several that cost the same, it is always the same one. An
    alternative shares at most `SHARED_MAX` of the shorter length with each better one; alternatives
    are found by making dearer what was used before. With a radius, routes without a path for it are
    left out.

    Raises
    ------
    UnknownZoneError
        A zone of the request is not in the map.
    NoRouteError
        No sequence of passages leads to any goal.
    OutsideError, TooNarrowError, NotConnectedError
        No route has a path for a robot of that radius; the error is that of the best.
    """
    for zone_id in request.named:
        if zone_id not in atlas.state.graph.nodes:
            raise UnknownZoneError("the map has no such zone")
    routes = Finder(atlas, request).routes()
    if request.radius is not None:
        routes = _with_paths(atlas, routes, request.radius)
    return tuple(sorted(islice(routes, request.alternatives), key=lambda route: route.cost))


def widest_place(atlas: Atlas, zone_id: str) -> Point:
    """Return the centre of the largest circle in a zone, in m, map frame."""
    return ground_of(atlas.state.metric, zone_id).widest_place


def _with_paths(atlas: Atlas, routes: Iterator[Route], radius: float) -> Iterator[Route]:
    """Yield the routes that have a path, with it; raises the first error where none has."""
    refused: SemtopoError | None = None
    is_passable = False
    for route in routes:
        try:
            path = _path(atlas, route, radius)
        except (OutsideError, TooNarrowError, NotConnectedError) as error:
            refused = refused or error
        else:
            is_passable = True
            yield replace(route, path=path)
    if refused is not None and not is_passable:
        raise refused


def _path(atlas: Atlas, route: Route, radius: float) -> Path:
    """Return the shortest path through the zones of a route and the doorways between them."""
    metric = atlas.state.metric
    parts: list[MappedZone | Doorway] = [metric.zones[it] for it in sorted(set(route.zones))]
    for one, other in sorted({(min(pair), max(pair)) for pair in pairwise(route.zones)}):
        parts += metric.doorways.between(one, other)
    return _space(tuple(parts), radius).path(route.points[0], route.points[-1])


@lru_cache(maxsize=SPACES_KEPT)
def _space(parts: tuple[MappedZone | Doorway, ...], radius: float) -> FreeSpace:
    return FreeSpace(joined(np.array([part.region for part in parts], dtype=np.object_)), radius)
