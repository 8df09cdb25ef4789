"""Questions in words, and answers in words (section 1: "by the means of semantic sentences").

In come a map and a sentence; out goes an answer that holds both structure and a sentence. The one
form known is `path from X to Y`. Names may stand in double quotes.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from itertools import pairwise

from semtopo.atlas import Atlas
from semtopo.errors import InvalidQuestionError
from semtopo.names import resolve, resolve_one
from semtopo.route import Place, Route, RouteRequest, find_routes

_NAME = r'(?:"([^"]+)"|(.+?))'
_PATH = re.compile(
    rf"\s*(?:(?:the|a)\s+)?path\s+from\s+{_NAME}\s+to\s+{_NAME}\s*[.?!]?\s*", re.IGNORECASE
)


@dataclass(frozen=True, slots=True)
class PathQuestion:
    """Asks for the way from one zone to another, by the names that were used."""

    source: str
    target: str


@dataclass(frozen=True, slots=True)
class PathAnswer:
    """A route, and the same in words."""

    route: Route
    sentence: str


def parse(text: str) -> PathQuestion:
    """Return what a sentence asks.

    Raises
    ------
    InvalidQuestionError
        It is none of the known forms.
    """
    found = _PATH.fullmatch(text)
    if found is None:
        raise InvalidQuestionError('expected a question like "path from corridor to C"')
    source, target = found[1] or found[2], found[3] or found[4]
    return PathQuestion(source.strip(), target.strip())


def answer(atlas: Atlas, text: str) -> PathAnswer:
    """Answer a sentence from a map.

    Raises
    ------
    InvalidQuestionError
        The sentence is none of the known forms.
    UnknownZoneError
        A name in it is that of no zone.
    AmbiguousZoneError
        A name in it is that of several zones.
    NoRouteError
        The zones are not connected in that direction.
    """
    question = parse(text)
    start = Place(resolve_one(atlas, question.source))
    goals = tuple(map(Place, resolve(atlas, question.target)))
    route = find_routes(atlas, RouteRequest(start=start, goals=goals))[0]
    return PathAnswer(route, describe(route))


def describe(route: Route) -> str:
    """Return a route in words; coordinates in m, map frame."""
    if not route.passages:
        return f"You are in {route.target} already."
    legs = [
        f"leave {zone_id} at ({passage.point[0]:.1f}, {passage.point[1]:.1f}) into {entered}"
        for passage, (zone_id, entered) in zip(route.passages, pairwise(route.zones), strict=True)
    ]
    passages = "1 passage" if len(legs) == 1 else f"{len(legs)} passages"
    words = ", then ".join(legs)
    return f"{words[0].upper()}{words[1:]}: {route.length:.1f} m, {passages}."
