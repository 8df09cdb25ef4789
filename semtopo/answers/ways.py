"""Answers about ways: paths with stops, connections, distances, the nearest of a class."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import islice, pairwise
from typing import TypeAlias

from semtopo.answers.bearings import goals_of, start_of, zone_of, zones_of
from semtopo.answers.values import (
    ConnectionAnswer,
    DistanceAnswer,
    Gap,
    NearestAnswer,
    PathAnswer,
)
from semtopo.atlas import Atlas
from semtopo.errors.ways import NearestFrontier, NoRouteError
from semtopo.freespace import Path
from semtopo.graph import Passage
from semtopo.journey import ANY_WAY, WayOptions
from semtopo.phrases import TOLD_MAX, at, capitalised, counted, listed
from semtopo.questions import (
    ConnectionQuestion,
    DistanceQuestion,
    Leg,
    Nearest,
    NearestQuestion,
    PathQuestion,
)
from semtopo.route import Place, Route, RouteRequest, find_routes

WayQuestion: TypeAlias = PathQuestion | ConnectionQuestion | DistanceQuestion | NearestQuestion
WayAnswer: TypeAlias = PathAnswer | ConnectionAnswer | DistanceAnswer | NearestAnswer


def answer_way(atlas: Atlas, question: WayQuestion, options: WayOptions = ANY_WAY) -> WayAnswer:
    """Answer a question about a way; with a radius, it comes with a path."""
    match question:
        case PathQuestion():
            return path(atlas, question, options)
        case ConnectionQuestion():
            return connection(atlas, question, options)
        case DistanceQuestion():
            return distance(atlas, question, options)
        case NearestQuestion():
            return nearest(atlas, question, options)


def path(atlas: Atlas, question: PathQuestion, options: WayOptions = ANY_WAY) -> PathAnswer:
    """Answer with the way along all legs; raises NoRouteError for the first that has none."""
    legs = tuple(_routes(atlas, start_of(atlas, question.start), question.legs, options))
    route = _joined(legs)
    return PathAnswer(_described(route), route, legs)


def connection(
    atlas: Atlas, question: ConnectionQuestion, options: WayOptions = ANY_WAY
) -> ConnectionAnswer:
    """Answer whether there is a way along all legs, and with the gap if there is none."""
    try:
        route = _joined(
            tuple(_routes(atlas, start_of(atlas, question.start), question.legs, options))
        )
    except NoRouteError as gap:
        found = Gap(
            gap.reachable, gap.reaching, gap.missing, gap.frontier, gap.restricted, gap.two_way
        )
        return ConnectionAnswer(f"No. {gap}", connected=False, gap=found)
    return ConnectionAnswer(f"Yes. {_described(route)}", connected=True, route=route)


def distance(
    atlas: Atlas, question: DistanceQuestion, options: WayOptions = ANY_WAY
) -> DistanceAnswer:
    """Answer how far it is; raises NoRouteError where there is no way."""
    route = _one_route(atlas, start_of(atlas, question.start), Leg(question.goal), options)
    extent = f"{route.length:.1f} m, through {counted(len(route.passages), 'passage')}"
    sentence = f"From {route.source} to {route.target} it is {extent}."
    return DistanceAnswer(sentence, route.length, route)


def nearest(
    atlas: Atlas, question: NearestQuestion, options: WayOptions = ANY_WAY
) -> NearestAnswer:
    """Answer which zone of a class is nearest; raises NoRouteError where there is no way to any."""
    leg = Leg(Nearest(question.zone_class))
    route = _one_route(atlas, start_of(atlas, question.start), leg, options)
    sentence = f"The nearest is {route.target}. {_described(route)}"
    return NearestAnswer(sentence, route.target, route)


def _routes(
    atlas: Atlas, start: Place, legs: Sequence[Leg], options: WayOptions
) -> Iterator[Route]:
    """Yield the best route of each leg; each begins where the one before ends."""
    for leg in legs:
        route = _one_route(atlas, start, leg, options)
        yield route
        start = Place(route.target, route.points[-1])


def _one_route(atlas: Atlas, start: Place, leg: Leg, options: WayOptions) -> Route:
    avoided = frozenset(zone for name in leg.avoiding for zone in zones_of(atlas, name))
    goals = goals_of(atlas, leg.goal)
    request = RouteRequest(
        start=start,
        goals=tuple(goal for goal in goals if goal.zone_id not in avoided) or goals,
        via=tuple(zone_of(atlas, name) for name in leg.via),
        avoid_zones=avoided,
        radius=options.radius,
        two_way=options.two_way,
    )
    try:
        return find_routes(atlas, request)[0]
    except NoRouteError as gap:
        frontier = _known_frontier(atlas, gap)
        raise NoRouteError(
            " ".join(_refusal(atlas, request, gap, None if gap.restricted else frontier)),
            reachable=gap.reachable,
            reaching=gap.reaching,
            missing=gap.missing,
            frontier=frontier,
            restricted=gap.restricted,
            two_way=gap.two_way,
        ) from None


def _known_frontier(atlas: Atlas, gap: NoRouteError) -> NearestFrontier | None:
    """Return the frontier of a gap; in a map without borders, none is known."""
    if gap.frontier is None or not atlas.state.metric.zones[gap.frontier.zone_id].border.is_known:
        return None
    return gap.frontier


def _joined(legs: Sequence[Route]) -> Route:
    """Return legs, each of which begins where the one before ends, as one route."""
    first, *others = legs
    return Route(
        (*first.zones, *(zone for leg in others for zone in leg.zones[1:])),
        tuple(passage for leg in legs for passage in leg.passages),
        (*first.points, *(point for leg in others for point in leg.points[1:])),
        math.fsum(leg.cost for leg in legs),
        math.fsum(leg.length for leg in legs),
        _joined_path([leg.path for leg in legs if leg.path is not None]),
    )


def _joined_path(paths: Sequence[Path]) -> Path | None:
    """Return paths, each of which begins where the one before ends, as one path."""
    if not paths:
        return None
    first, *others = paths
    points = (*first.points, *(point for path in others for point in path.points[1:]))
    length = math.fsum(path.length for path in paths)
    return Path(points, length, min(path.clearance for path in paths))


def _described(route: Route) -> str:
    """Return a route in words, up to `TOLD_MAX` passages of it."""
    if not route.passages:
        return f"You are in {route.target} already."
    moves = zip(route.passages, pairwise(route.zones), strict=True)
    told = [
        f"leave {left} {at(passage.point)} into {entered}{_against(passage, left)}"
        for passage, (left, entered) in islice(moves, TOLD_MAX)
    ]
    if len(route.passages) > len(told):
        told.append(f"{len(route.passages) - len(told)} passages more")
    extent = f"{route.length:.1f} m, {counted(len(route.passages), 'passage')}"
    return capitalised(f"{', then '.join(told)}: {extent}.{_room(route)}")


def _against(passage: Passage, left: str) -> str:
    """Say that a passage is used against its direction, where it is."""
    return "" if passage.source == left else ", against the direction in which it is known"


def _room(route: Route) -> str:
    """Say how long the path of a route is for the robot, if it was asked for."""
    path = route.path
    return "" if path is None else f" The path for the robot is {path.length:.1f} m long."


def _refusal(
    atlas: Atlas, request: RouteRequest, gap: NoRouteError, frontier: NearestFrontier | None
) -> Iterator[str]:
    """Say why there is no way, with all that is known of the gap, a sentence for each."""
    start = request.start.zone_id
    goal = listed([place.zone_id for place in request.goals], "or")
    via = f" via {listed(request.via)}" if request.via else ""
    avoiding = f" avoiding {listed(sorted(request.avoid_zones))}" if request.avoid_zones else ""
    yield f"There is no way from {start} to {goal}{via}{avoiding}{_reason(gap)}"
    yield from _looked_into(atlas, start)
    yield from _known_ways(start, goal, gap)
    yield from _way_out(gap, frontier)


def _reason(gap: NoRouteError) -> str:
    """Say in half a sentence what is in the way."""
    missing = gap.missing
    if gap.restricted:
        return "; there would be one, but for what is closed or avoided."
    if missing is None:
        return " yet."
    return (
        f" yet: {missing.source} -> {missing.target} is not known, though"
        f" {missing.target} -> {missing.source} has been since step {missing.since}."
    )


def _looked_into(atlas: Atlas, zone_id: str) -> Iterator[str]:
    """Say from where a zone was looked into, if no way out of it is known, nor is one in it."""
    pairs = atlas.state.graph.pairs
    before = list(dict.fromkeys(source for source, target in pairs if target == zone_id))
    if before and atlas.state.here != zone_id and all(source != zone_id for source, _ in pairs):
        yield f"{zone_id} was only looked into, from {listed(before)}."


def _known_ways(start: str, goal: str, gap: NoRouteError) -> Iterator[str]:
    """Say which zones can be reached from the start, and from which the goal can be reached."""
    onwards = [zone for zone in gap.reachable if zone != start]
    yield f"From {start} one reaches {listed(onwards) if onwards else 'no other zone'}."
    before = [zone for zone in gap.reaching if zone != goal]
    yield f"One reaches {goal} from {listed(before) if before else 'no other zone'}."


def _way_out(gap: NoRouteError, frontier: NearestFrontier | None) -> Iterator[str]:
    """Say if using passages both ways helps, and where exploring may, if anywhere."""
    if gap.two_way:
        yield "With two_way, passages are used against their direction too, and there is a way."
    if frontier is not None:
        where = f"{at(frontier.point)} in {frontier.zone_id}"
        yield f"The frontier nearest to closing the gap is {where}."
