"""Questions in words, and answers in words (section 1: "by the means of semantic sentences").

In come a map and a sentence; out goes an answer that holds both structure and a sentence. The one
form known is `path from X to Y`. Names may stand in double quotes; case matters only where two
zones differ in nothing else.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass

from semtopo.errors import InvalidQuestionError, UnknownZoneError
from semtopo.mapper import MapState
from semtopo.route import Route, find_route

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


def answer(state: MapState, text: str) -> PathAnswer:
    """Answer a sentence from a map.

    Raises
    ------
    InvalidQuestionError
        The sentence is none of the known forms.
    UnknownZoneError
        A name in it is that of no zone.
    NoRouteError
        The zones are not connected in that direction.
    """
    question = parse(text)
    source = find_zone(state.graph.nodes, question.source)
    target = find_zone(state.graph.nodes, question.target)
    route = find_route(state.graph, source, target)
    return PathAnswer(route, describe(route))


def find_zone(known: Iterable[str], name: str) -> str:
    """Return the zone that a name means: the same word, or the only one alike but for case.

    Raises
    ------
    UnknownZoneError
        There is no such zone, or several.
    """
    zones = list(known)
    if name in zones:
        return name
    alike = [zone for zone in zones if zone.casefold() == name.casefold()]
    if len(alike) == 1:
        return alike[0]
    raise UnknownZoneError("the map has no zone of that name")


def describe(route: Route) -> str:
    """Return a route in words; coordinates in m, map frame."""
    if not route.passages:
        return f"You are in {route.target} already."
    legs = [
        f"leave {passage.source} at ({passage.point[0]:.1f}, {passage.point[1]:.1f})"
        f" into {passage.target}"
        for passage in route.passages
    ]
    count = len(legs)
    extent = "1 passage" if count == 1 else f"{count} passages, {route.length:.1f} m between them"
    words = ", then ".join(legs)
    return f"{words[0].upper()}{words[1:]}: {extent}."
