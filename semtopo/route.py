"""Routes through an atlas: which passages lead from one place to another, and what that costs.

In come an atlas and a request; out go routes, the best first. A zone is a region, not a point, so
distances do not add up from zone to zone: the search goes from passage to passage, and what counts
is the way between the two inside a zone.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from functools import lru_cache
from itertools import islice, pairwise

import numpy as np
import shapely

from semtopo.atlas import Atlas
from semtopo.doorways import Doorway
from semtopo.errors import UnknownZoneError
from semtopo.errors.ways import (
    GroundlessPassage,
    NoRouteError,
    NotConnectedError,
    OutsideError,
    TooNarrowError,
)
from semtopo.finder import SHARED_MAX, Finder
from semtopo.freespace import FreeSpace, Path
from semtopo.geometry import Region, joined, polygonal
from semtopo.graph import PassageKey
from semtopo.ground import ground_of
from semtopo.inset import inset
from semtopo.journey import Place, Route, RouteRequest
from semtopo.metric import MappedZone
from semtopo.network import CostModel
from semtopo.types import Point

SEARCHES = 8
"""How often a way is looked for that leaves out what was too narrow before."""

AROUND = 0.3
"""m; how far into both zones a robot must come to have passed a doorway, beside its own width."""

DOORS_KEPT = 4096
"""Doorways of which it is known if a robot fits through."""

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
        seen = [frozenset(_too_narrow(atlas, route, radius)) for route in tried]
        likely = [
            route for route, keys in zip(tried, seen, strict=True) if best is None or not keys
        ]
        passable = list(_passable(atlas, likely, radius))
        if passable:
            return passable
        best = best or tried[0]
        unlikely += [route for route in tried if route not in likely]
        found = frozenset().union(*seen)
        if found <= narrow:
            break
        narrow |= found
    assert best is not None  # noqa: S101 -- a search without a route raises
    passable = list(islice(_passable(atlas, unlikely, radius), 1))
    if passable:
        return passable
    try:
        return [replace(best, path=_free_space(atlas, best, radius).path(*_ends(best)))]
    except NotConnectedError as error:
        raise _groundless(atlas, best) or error from None


def _passable(atlas: Atlas, routes: Iterable[Route], radius: float) -> Iterator[Route]:
    """Yield the routes that have a path for the robot, with it."""
    for route in routes:
        path = _path(_free_space(atlas, route, radius), route)
        if path is not None:
            yield replace(route, path=path)


def _groundless(atlas: Atlas, route: Route) -> NotConnectedError | None:
    """Return the error that names the first passage of a route without ground, if there is one."""
    metric = atlas.state.metric
    for passage in route.passages:
        ends = metric.zones[passage.source].region, metric.zones[passage.target].region
        doors = metric.doorways.between(passage.source, passage.target)
        if not any(all(door.region.intersects(end) for end in ends) for door in doors):
            source, target, point = passage.source, passage.target, passage.point
            return NotConnectedError(
                f"No ground is known between {source} and {target}: the passage at"
                f" ({point[0]:.1f}, {point[1]:.1f}) was only seen from elsewhere.",
                GroundlessPassage(source, target, point),
            )
    return None


def _ends(route: Route) -> tuple[Point, Point]:
    return route.points[0], route.points[-1]


def _too_narrow(atlas: Atlas, route: Route, radius: float) -> Iterator[PassageKey]:
    """Yield the passages of a route through whose doorways the robot does not fit."""
    metric = atlas.state.metric
    for passage in route.passages:
        ends = metric.zones[passage.source], metric.zones[passage.target]
        doors = metric.doorways.between(passage.source, passage.target)
        if not any(_fits(door, ends, radius) for door in doors):
            yield passage.key


@lru_cache(maxsize=DOORS_KEPT)
def _fits(door: Doorway, ends: tuple[MappedZone, MappedZone], radius: float) -> bool:
    """Say whether a robot can go through a doorway from the one zone to the other."""
    around = door.region.buffer(AROUND + 2 * radius).bounds
    near = [polygonal(shapely.clip_by_rect(end.region, *around)) for end in ends]
    halls = [_largest(inset(zone, radius)) for zone in near]
    whole = joined(np.array([door.region, *near], dtype=np.object_))
    parts = shapely.get_parts(inset(whole, radius))
    return any(all(part.intersects(hall) for hall in halls) for part in parts)


def _largest(region: Region) -> Region:
    """Return the largest part of a region; the region itself where it is empty."""
    return max(shapely.get_parts(region), key=shapely.area, default=region)


def _path(space: FreeSpace, route: Route) -> Path | None:
    """Return the shortest path of a route, `None` where the robot does not fit."""
    try:
        return space.find(*_ends(route))
    except (OutsideError, TooNarrowError):
        return None


def _free_space(atlas: Atlas, route: Route, radius: float) -> FreeSpace:
    """Return the zones of a route and the doorways between them, for a robot of some radius."""
    metric = atlas.state.metric
    parts: list[MappedZone | Doorway] = [metric.zones[it] for it in sorted(set(route.zones))]
    for one, other in sorted({(min(pair), max(pair)) for pair in pairwise(route.zones)}):
        parts += metric.doorways.between(one, other)
    return _space(tuple(parts), radius)


@lru_cache(maxsize=SPACES_KEPT)
def _space(parts: tuple[MappedZone | Doorway, ...], radius: float) -> FreeSpace:
    return FreeSpace(joined(np.array([part.region for part in parts], dtype=np.object_)), radius)
