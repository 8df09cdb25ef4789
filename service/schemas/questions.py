"""Questions in words, and the answers to each kind of them: the library's, as JSON has them.

Zones are named by their ids; points, lengths and areas are in m and m^2, map frame.
"""

from __future__ import annotations

from typing import Annotated, Literal, TypeAlias

from pydantic import BaseModel, Field

from semtopo.answers.values import Frontier, Gap, Growth, ListedClass, ListedZone, ZonePlace
from semtopo.documents import Document
from semtopo.expectations import EXAMPLES
from semtopo.types import Point
from service.schemas.answers import Radius, RouteAnswer
from service.schemas.maps import GraphEdge

TEXT_MAX = 2_000  # characters of a question


class QueryRequest(Document):
    """A question in words, and how the robot goes.

    With its radius, in m, ways come with a path; with `two_way`, passages are used against their
    direction too.
    """

    text: Annotated[
        str,
        Field(strict=True, min_length=1, max_length=TEXT_MAX, examples=sorted(EXAMPLES.values())),
    ]
    radius: Radius | None = None
    two_way: Annotated[bool, Field(strict=True)] = False


class PathReply(BaseModel):
    """A way: all of it, and leg by leg, one for each goal."""

    kind: Literal["path"]
    sentence: str
    route: RouteAnswer
    legs: list[RouteAnswer]


class ConnectionReply(BaseModel):
    """Whether there is a way: the way, or the gap."""

    kind: Literal["connection"]
    sentence: str
    connected: bool
    route: RouteAnswer | None
    gap: Gap | None


class DistanceReply(BaseModel):
    """How long a way is."""

    kind: Literal["distance"]
    sentence: str
    length: float
    route: RouteAnswer


class NearestReply(BaseModel):
    """The nearest zone of a class, and the way there."""

    kind: Literal["nearest"]
    sentence: str
    zone: str
    route: RouteAnswer


class HereReply(BaseModel):
    """Where the robot was at the last step; a position may be in no zone that was seen."""

    kind: Literal["here"]
    sentence: str
    zone: str | None
    position: Point | None


class LocationReply(BaseModel):
    """Where the zones of a name are."""

    kind: Literal["location"]
    sentence: str
    zones: list[ZonePlace]


class NeighboursReply(BaseModel):
    """The zones that a passage links with a zone, and these passages."""

    kind: Literal["neighbours"]
    sentence: str
    zone: str
    neighbours: list[str]
    passages: list[GraphEdge]


class ReachableReply(BaseModel):
    """The other zones that can be reached from a zone."""

    kind: Literal["reachable"]
    sentence: str
    zone: str
    zones: list[str]


class ReachingReply(BaseModel):
    """The other zones from which a zone can be reached."""

    kind: Literal["reaching"]
    sentence: str
    zone: str
    zones: list[str]


class SeenReply(BaseModel):
    """What a step found, and which zones it made larger."""

    kind: Literal["seen"]
    sentence: str
    step: int
    zone: str | None
    position: Point | None
    zones: list[str]
    passages: list[GraphEdge]
    grown: list[str] | None


class ChangesReply(BaseModel):
    """What is different after one step from after an earlier one."""

    kind: Literal["changes"]
    sentence: str
    since: int
    until: int
    zones: list[str]
    passages: list[GraphEdge]
    gone: list[str]
    grown: list[Growth] | None


class ZonesReply(BaseModel):
    """All zones, or those of a class."""

    kind: Literal["zones"]
    sentence: str
    zones: list[ListedZone]


class ClassesReply(BaseModel):
    """All classes of zones."""

    kind: Literal["classes"]
    sentence: str
    classes: list[ListedClass]


class FrontiersReply(BaseModel):
    """Where a zone is not explored yet, the longest frontier first."""

    kind: Literal["frontiers"]
    sentence: str
    zone: str
    frontiers: list[Frontier]


QueryAnswer: TypeAlias = Annotated[
    PathReply
    | ConnectionReply
    | DistanceReply
    | NearestReply
    | HereReply
    | LocationReply
    | NeighboursReply
    | ReachableReply
    | ReachingReply
    | SeenReply
    | ChangesReply
    | ZonesReply
    | ClassesReply
    | FrontiersReply,
    Field(discriminator="kind"),
]
"""The answer to a question; `kind` says which."""
