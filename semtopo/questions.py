"""What can be asked of a map: one value for each kind of question.

Names stand as they were said; nothing here knows whether the map has them. A `position` is that of
a name in the sentence, in characters from 0; questions that differ in nothing else are equal.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TypeAlias

STOPS_MAX = 8
"""Zones to go to or through in one question: each is a search of its own."""

AVOIDED_MAX = 64
"""Names to avoid in one question."""


@dataclass(frozen=True, slots=True)
class Named:
    """A zone, or a class of zones, by the name that was used."""

    name: str
    position: int = field(default=0, compare=False)


@dataclass(frozen=True, slots=True)
class Here:
    """The zone where the robot is."""


@dataclass(frozen=True, slots=True)
class Nearest:
    """The nearest zone of a class."""

    zone_class: Named


Place: TypeAlias = Named | Here
Goal: TypeAlias = Named | Here | Nearest


@dataclass(frozen=True, slots=True)
class Leg:
    """A goal, the zones to pass on the way to it, in order, and those not to pass."""

    goal: Goal
    via: tuple[Named, ...] = ()
    avoiding: tuple[Named, ...] = ()


@dataclass(frozen=True, slots=True)
class PathQuestion:
    """Asks for the way from a place to a goal, and from there to the next."""

    start: Place
    legs: tuple[Leg, ...]


@dataclass(frozen=True, slots=True)
class ConnectionQuestion:
    """Asks whether there is such a way."""

    start: Place
    legs: tuple[Leg, ...]


@dataclass(frozen=True, slots=True)
class DistanceQuestion:
    """Asks how long the way from a place to a goal is."""

    start: Place
    goal: Goal


@dataclass(frozen=True, slots=True)
class NearestQuestion:
    """Asks which zone of a class is nearest to a place."""

    zone_class: Named
    start: Place = field(default_factory=Here)


@dataclass(frozen=True, slots=True)
class HereQuestion:
    """Asks where the robot is."""


@dataclass(frozen=True, slots=True)
class LocationQuestion:
    """Asks where a zone is."""

    zone: Named


@dataclass(frozen=True, slots=True)
class NeighboursQuestion:
    """Asks which zones a passage links with a zone."""

    zone: Place


@dataclass(frozen=True, slots=True)
class ReachableQuestion:
    """Asks which zones can be reached from a zone."""

    zone: Place


@dataclass(frozen=True, slots=True)
class ReachingQuestion:
    """Asks from which zones a zone can be reached."""

    zone: Place


@dataclass(frozen=True, slots=True)
class SeenQuestion:
    """Asks what was found at a step."""

    step: int


@dataclass(frozen=True, slots=True)
class ChangesQuestion:
    """Asks what is different after step `until` from after step `since`; `None` is now."""

    since: int
    until: int | None = None


@dataclass(frozen=True, slots=True)
class ZonesQuestion:
    """Asks for all zones, or those of a class."""

    zone_class: Named | None = None


@dataclass(frozen=True, slots=True)
class ClassesQuestion:
    """Asks for all classes of zones."""


@dataclass(frozen=True, slots=True)
class FrontiersQuestion:
    """Asks where a zone is not explored yet."""

    zone: Place


Question: TypeAlias = (
    PathQuestion
    | ConnectionQuestion
    | DistanceQuestion
    | NearestQuestion
    | HereQuestion
    | LocationQuestion
    | NeighboursQuestion
    | ReachableQuestion
    | ReachingQuestion
    | SeenQuestion
    | ChangesQuestion
    | ZonesQuestion
    | ClassesQuestion
    | FrontiersQuestion
)
