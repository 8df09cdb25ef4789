"""The dense path of a route, for a round robot: leg by leg, from zone to zone to be visited.

In come a map and a route on it; out go its path, or why there is none, and which of its doorways
are too narrow.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from functools import lru_cache
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import shapely

from semtopo.atlas import Atlas
from semtopo.doorways import Doorway
from semtopo.errors.ways import GroundlessPassage, NotConnectedError, OutsideError, TooNarrowError
from semtopo.freespace import FreeSpace, Path
from semtopo.geometry import Region, joined, nearest_point, polygonal
from semtopo.graph import PassageKey
from semtopo.inset import inset
from semtopo.journey import Route
from semtopo.metric import MappedZone
from semtopo.types import Point

AROUND = 0.3
"""m; how far into both zones a robot must come to have passed a doorway, beside its own width."""

DOORS_KEPT = 4096
"""Doorways of which it is known if a robot fits through."""

SPACES_KEPT = 32
"""Free spaces in memory, of the latest paths; each is a triangulation of all zones on the way."""


class _Leg(NamedTuple):
    """A part of a route: through which zones, and between which places, in m."""

    zones: tuple[str, ...]
    start: Point
    end: Point


def path_of(atlas: Atlas, route: Route, via: Sequence[str], radius: float) -> Path:
    """Return the shortest path of a route that goes into the zones `via` in turn.

    To visit a zone is to be in the largest hall of it where the robot (`radius` in m) fits, at the
    place nearest to where the route enters.

    Raises
    ------
    OutsideError, TooNarrowError, NotConnectedError
        There is no path for that robot.
    """
    try:
        legs = _legs(atlas, route, via, radius)
        return _joined(_free_space(atlas, leg, radius).path(leg.start, leg.end) for leg in legs)
    except NotConnectedError as error:
        raise _groundless(atlas, route) or error from None


def find_path(atlas: Atlas, route: Route, via: Sequence[str], radius: float) -> Path | None:
    """Return the same as `path_of`, but `None` where there is none; why not is costly to tell."""
    paths = []
    for leg in _legs(atlas, route, via, radius):
        try:
            path = _free_space(atlas, leg, radius).find(leg.start, leg.end)
        except (OutsideError, TooNarrowError):
            return None
        if path is None:
            return None
        paths.append(path)
    return _joined(paths)


def _legs(atlas: Atlas, route: Route, via: Sequence[str], radius: float) -> Iterator[_Leg]:
    """Yield the legs of a route, each from where the last one ended."""
    first, start = 0, route.points[0]
    for zone_id in via:
        last = route.zones.index(zone_id, first)
        if last > first:
            hall = _largest(_space((atlas.state.metric.zones[zone_id],), radius).inset)
            entry = route.points[last]
            end = entry if hall.is_empty else nearest_point(hall, entry)
            yield _Leg(route.zones[first : last + 1], start, end)
            first, start = last, end
    yield _Leg(route.zones[first:], start, route.points[-1])


def _joined(legs: Iterable[Path]) -> Path:
    """Return paths that follow one another as one."""
    paths = list(legs)
    if len(paths) == 1:
        return paths[0]
    points = (paths[0].points[0], *(point for path in paths for point in path.points[1:]))
    clearance = min(path.clearance for path in paths)
    return Path(points, math.fsum(path.length for path in paths), clearance)


def _free_space(atlas: Atlas, leg: _Leg, radius: float) -> FreeSpace:
    """Return the zones of a leg and the doorways between them, for a robot of some radius."""
    metric = atlas.state.metric
    parts: list[MappedZone | Doorway] = [metric.zones[it] for it in sorted(set(leg.zones))]
    for one, other in sorted({(min(pair), max(pair)) for pair in pairwise(leg.zones)}):
        parts += metric.doorways.between(one, other)
    return _space(tuple(parts), radius)


@lru_cache(maxsize=SPACES_KEPT)
def _space(parts: tuple[MappedZone | Doorway, ...], radius: float) -> FreeSpace:
    return FreeSpace(joined(np.array([part.region for part in parts], dtype=np.object_)), radius)


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


def too_narrow(atlas: Atlas, route: Route, radius: float) -> Iterator[PassageKey]:
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
