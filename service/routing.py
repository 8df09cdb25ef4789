"""Understand what a route is asked from, to, through and around, by the names that people use."""

from __future__ import annotations

from semtopo import (
    AmbiguousZoneError,
    Atlas,
    CostModel,
    OutsideError,
    Place,
    RouteRequest,
    UnknownPositionError,
    UnknownZoneError,
    resolve,
    resolve_one,
)
from semtopo.graph import PassageKey
from semtopo.ground import nearest_ground, zone_at
from service.errors import InvalidRequestError, UnknownPassageError
from service.schemas.answers import RouteQuery

HERE = "here"
ARROW = "->"


def route_request(atlas: Atlas, asked: RouteQuery) -> RouteRequest:
    """Return what is asked for, on a map.

    Raises
    ------
    UnknownZoneError, AmbiguousZoneError, UnknownPassageError
        A name means nothing, or too much.
    UnknownPositionError
        The way is asked from where the robot is, which is not known.
    OutsideError
        The point to begin at is in no zone, or not in the one that is named.
    InvalidRequestError
        It is not said where to begin.
    """
    zones, passages = _avoided(atlas, asked.avoid)
    return RouteRequest(
        start=_start(atlas, asked),
        goals=tuple(map(Place, resolve(atlas, asked.target))),
        via=tuple(resolve_one(atlas, name) for name in asked.via),
        avoid_zones=zones,
        avoid_passages=passages,
        two_way=asked.two_way,
        cost=CostModel(asked.length_cost, asked.passage_cost),
        radius=asked.radius,
        alternatives=asked.alternatives,
    )


def _start(atlas: Atlas, asked: RouteQuery) -> Place:
    named = None if asked.source is None else _named(atlas, asked.source)
    if asked.x is None and asked.y is None and named is not None:
        return named
    if asked.x is None or asked.y is None:
        raise InvalidRequestError("from, or x and y together, must say where to begin")
    point, metric = (asked.x, asked.y), atlas.state.metric
    among = list(metric.zones) if named is None else [named.zone_id]
    zone_id = zone_at(metric, point, among)
    if zone_id is None:
        where = "in any zone" if named is None else "in the zone that is named"
        raise OutsideError("start", nearest_ground(metric, point, among), f"is not {where}")
    return Place(zone_id, point)


def _named(atlas: Atlas, name: str) -> Place:
    """Return the place that a name means: a zone, or where the robot is."""
    try:
        return Place(resolve_one(atlas, name))
    except UnknownZoneError:
        if name.casefold() != HERE:
            raise
    if atlas.state.here is None:
        raise UnknownPositionError("it is not known in which zone the robot is")
    return Place(atlas.state.here, atlas.state.position)


def _avoided(atlas: Atlas, names: tuple[str, ...]) -> tuple[frozenset[str], frozenset[PassageKey]]:
    """Return the zones and passages that some names mean: a zone first, where it may be either."""
    zones: set[str] = set()
    passages: set[PassageKey] = set()
    for name in names:
        try:
            zones.update(resolve(atlas, name))
        except UnknownZoneError:
            if ARROW not in name:
                raise
            passages.update(_passages(atlas, name))
    return frozenset(zones), frozenset(passages)


def _passages(atlas: Atlas, name: str) -> set[PassageKey]:
    """Return the passages from one zone to another, named as "A->B"."""
    found: set[PassageKey] = set()
    parts = name.split(ARROW)
    for cut in range(1, len(parts)):  # the arrow may be part of a name
        ends = (ARROW.join(parts[:cut]).strip(), ARROW.join(parts[cut:]).strip())
        try:
            source, target = (set(resolve(atlas, end)) for end in ends)
        except (UnknownZoneError, AmbiguousZoneError):
            continue
        keys = atlas.state.graph.passages
        found |= {key for key in keys if key[0] in source and key[1] in target}
    if not found:
        raise UnknownPassageError("the map has no such passage")
    return found
