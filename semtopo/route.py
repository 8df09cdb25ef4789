"""Routes through an atlas: which passages lead from one place to another, and what that costs.

In come an atlas and a request; out go routes, the best first. A zone is a region, not a point, so
distances do not add up from zone to zone: the search goes from passage to passage, and what counts
is the way between the two inside a zone.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import islice

from semtopo.atlas import Atlas
from semtopo.dense import find_path, path_of, too_narrow
from semtopo.errors import UnknownZoneError
from semtopo.errors.ways import NoRouteError
from semtopo.finder import SHARED_MAX, Finder
from semtopo.graph import PassageKey
from semtopo.ground import ground_of
from semtopo.journey import Place, Route, RouteRequest
from semtopo.network import CostModel
from semtopo.types import Point

SEARCHES = 8
"""How often a way is looked for that leaves out what was too narrow before."""

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
    if request.radius is None:
        routes = list(islice(Finder(atlas, request).routes(), request.alternatives))
    else:
        routes = _with_paths(atlas, request, request.radius)
    return tuple(sorted(routes, key=lambda route: route.cost))


def widest_place(atlas: Atlas, zone_id: str) -> Point:
    """Return the centre of the largest circle in a zone, in m, map frame."""
    return ground_of(atlas.state.metric, zone_id).widest_place


def _with_paths(atlas: Atlas, request: RouteRequest, radius: float) -> list[Route]:
    """Return the best routes that have a path, with it; raises the error of the best if none has.

    Passages that seem too narrow are left out, and the search begins anew. What seems so may prove
    otherwise, for a robot that comes from another side; so the best routes are tried all the same,
    and the others if nothing else is left.
    """
    narrow: frozenset[PassageKey] = frozenset()
    best: Route | None = None
    unlikely: list[Route] = []
    for _ in range(SEARCHES):
        avoided = replace(request, avoid_passages=request.avoid_passages | narrow)
        try:
            tried = list(islice(Finder(atlas, avoided).routes(), request.alternatives))
        except NoRouteError:
            if best is None:
                raise
            break
        seen = [frozenset(too_narrow(atlas, route, radius)) for route in tried]
        likely = [
            route for route, keys in zip(tried, seen, strict=True) if best is None or not keys
        ]
        passable = list(_passable(atlas, likely, request.via, radius))
        if passable:
            return passable
        best = best or tried[0]
        unlikely += [route for route in tried if route not in likely]
        found = frozenset().union(*seen)
        if found <= narrow:
            break
        narrow |= found
    assert best is not None  # noqa: S101 -- a search without a route raises
    passable = list(islice(_passable(atlas, unlikely, request.via, radius), 1))
    if passable:
        return passable
    return [replace(best, path=path_of(atlas, best, request.via, radius))]


def _passable(
    atlas: Atlas, routes: Iterable[Route], via: Sequence[str], radius: float
) -> Iterator[Route]:
    """Yield the routes that have a path for the robot, with it."""
    for route in routes:
        path = find_path(atlas, route, via, radius)
        if path is not None:
            yield replace(route, path=path)
