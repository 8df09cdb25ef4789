"""What answers hold: a sentence, and the same as structure; one value for each kind of question.

Zones are named by their ids. Points, lengths and areas are in m and m^2, map frame. Where several
things are told, they are in order of finding, if nothing else is said.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, TypeAlias

from semtopo.errors.ways import MissingPassage, NearestFrontier
from semtopo.graph import Passage
from semtopo.route import Route
from semtopo.types import Point


@dataclass(frozen=True, slots=True)
class PathAnswer:
    """A way: all of it, and leg by leg, one for each goal."""

    kind: ClassVar[str] = "path"
    sentence: str
    route: Route
    legs: tuple[Route, ...]


@dataclass(frozen=True, slots=True)
class Gap:
    """Why there is no way: what a `NoRouteError` tells."""

    reachable: tuple[str, ...]
    reaching: tuple[str, ...]
    missing: MissingPassage | None
    frontier: NearestFrontier | None
    restricted: bool
    two_way: bool


@dataclass(frozen=True, slots=True)
class ConnectionAnswer:
    """Whether there is a way: the way, or the gap."""

    kind: ClassVar[str] = "connection"
    sentence: str
    connected: bool
    route: Route | None = None
    gap: Gap | None = None


@dataclass(frozen=True, slots=True)
class DistanceAnswer:
    """How long a way is: `length` in m."""

    kind: ClassVar[str] = "distance"
    sentence: str
    length: float
    route: Route


@dataclass(frozen=True, slots=True)
class NearestAnswer:
    """The nearest zone of a class, and the way there."""

    kind: ClassVar[str] = "nearest"
    sentence: str
    zone: str
    route: Route


@dataclass(frozen=True, slots=True)
class HereAnswer:
    """Where the robot was at the last step; a position may be in no zone that was seen."""

    kind: ClassVar[str] = "here"
    sentence: str
    zone: str | None
    position: Point | None


@dataclass(frozen=True, slots=True)
class ZonePlace:
    """A zone: the middle of its widest place, and its area."""

    zone: str
    point: Point
    area: float


@dataclass(frozen=True, slots=True)
class LocationAnswer:
    """Where the zones of a name are."""

    kind: ClassVar[str] = "location"
    sentence: str
    zones: tuple[ZonePlace, ...]


@dataclass(frozen=True, slots=True)
class NeighboursAnswer:
    """The zones that a passage links with a zone, and these passages."""

    kind: ClassVar[str] = "neighbours"
    sentence: str
    zone: str
    neighbours: tuple[str, ...]
    passages: tuple[Passage, ...]


@dataclass(frozen=True, slots=True)
class ReachableAnswer:
    """The other zones that can be reached from a zone."""

    kind: ClassVar[str] = "reachable"
    sentence: str
    zone: str
    zones: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class ReachingAnswer:
    """The other zones from which a zone can be reached."""

    kind: ClassVar[str] = "reaching"
    sentence: str
    zone: str
    zones: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class SeenAnswer:
    """What a step found; `grown` are the zones that it made larger, `None` if that is not known."""

    kind: ClassVar[str] = "seen"
    sentence: str
    step: int
    zone: str | None
    position: Point | None
    zones: tuple[str, ...]
    passages: tuple[Passage, ...]
    grown: tuple[str, ...] | None


@dataclass(frozen=True, slots=True)
class Growth:
    """A zone whose ground changed: its area in m^2 before and after."""

    zone: str
    before: float
    after: float


@dataclass(frozen=True, slots=True)
class ChangesAnswer:
    """What is different after step `until` from after step `since`: zones and passages found.

    `gone` are zones that became part of others; `grown` is `None` where areas are not known.
    """

    kind: ClassVar[str] = "changes"
    sentence: str
    since: int
    until: int
    zones: tuple[str, ...]
    passages: tuple[Passage, ...]
    gone: tuple[str, ...]
    grown: tuple[Growth, ...] | None


@dataclass(frozen=True, slots=True)
class ListedZone:
    """A zone with all that it is called."""

    zone: str
    label: str
    zone_class: str | None
    aliases: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class ZonesAnswer:
    """All zones, or those of a class."""

    kind: ClassVar[str] = "zones"
    sentence: str
    zones: tuple[ListedZone, ...]


@dataclass(frozen=True, slots=True)
class ListedClass:
    """A class, and the zones that are of it."""

    zone_class: str
    zones: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class ClassesAnswer:
    """All classes of zones."""

    kind: ClassVar[str] = "classes"
    sentence: str
    classes: tuple[ListedClass, ...]


@dataclass(frozen=True, slots=True)
class Frontier:
    """A piece of border behind which nothing is known: its middle, and its length in m."""

    point: Point
    length: float


@dataclass(frozen=True, slots=True)
class FrontiersAnswer:
    """Where a zone is not explored yet, the longest frontier first."""

    kind: ClassVar[str] = "frontiers"
    sentence: str
    zone: str
    frontiers: tuple[Frontier, ...]


Answer: TypeAlias = (
    PathAnswer
    | ConnectionAnswer
    | DistanceAnswer
    | NearestAnswer
    | HereAnswer
    | LocationAnswer
    | NeighboursAnswer
    | ReachableAnswer
    | ReachingAnswer
    | SeenAnswer
    | ChangesAnswer
    | ZonesAnswer
    | ClassesAnswer
    | FrontiersAnswer
)
