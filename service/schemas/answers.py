"""Routes, as they are asked for and answered."""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

from semtopo.documents import COORDINATE_MAX, LABEL_LENGTH_MAX
from semtopo.journey import ALTERNATIVES_MAX, RADIUS_MAX, STOPS_MAX
from semtopo.network import COST_MAX
from semtopo.types import Point
from service.schemas.steps import SEQ_MAX

AVOIDED_MAX = 100

Name = Annotated[str, Field(min_length=1, max_length=LABEL_LENGTH_MAX)]
"""Of a zone: its id, its label, an alias or its class."""

Avoided = Annotated[str, Field(min_length=1, max_length=2 * LABEL_LENGTH_MAX + 10)]
"""A zone, or a passage as "A->B"."""

Coordinate = Annotated[float, Field(ge=-COORDINATE_MAX, le=COORDINATE_MAX, allow_inf_nan=False)]
Cost = Annotated[float, Field(ge=0, le=COST_MAX, allow_inf_nan=False)]
Radius = Annotated[float, Field(ge=0, le=RADIUS_MAX, allow_inf_nan=False)]


class RouteQuery(BaseModel):
    """Asks for the way from a zone, or a point, to the nearest zone of a name."""

    model_config = ConfigDict(populate_by_name=True)

    source: Annotated[
        Name | None,
        Field(alias="from", description="a zone; `here` for the robot's place, if no zone is so"),
    ] = None
    target: Annotated[Name, Field(alias="to", description="a zone, or several of a label or class")]
    via: Annotated[
        tuple[Name, ...], Field(max_length=STOPS_MAX, description="zones to go through, in order")
    ] = ()
    avoid: Annotated[
        tuple[Avoided, ...],
        Field(max_length=AVOIDED_MAX, description="zones not to enter, and passages, as A->B"),
    ] = ()
    x: Annotated[Coordinate | None, Field(description="where to begin, in m")] = None
    y: Annotated[Coordinate | None, Field(description="where to begin, in m")] = None
    two_way: Annotated[bool, Field(description="use passages against their direction too")] = False
    radius: Annotated[
        Radius | None, Field(description="of the robot, in m: a dense path comes along")
    ] = None
    alternatives: Annotated[
        int, Field(ge=1, le=ALTERNATIVES_MAX, description="how many routes, at most")
    ] = 1
    length_cost: Annotated[Cost, Field(description="what a metre costs")] = 1.0
    passage_cost: Annotated[Cost, Field(description="what a passage costs")] = 0.0
    at: Annotated[int | None, Field(ge=0, le=SEQ_MAX, description="as of this step")] = None


class RoutePassage(BaseModel):
    """A passage on a route: `n` is its number, where not 0."""

    source: str
    target: str
    point: Point
    n: int | None = None
    backwards: bool | None = None


class PathAnswer(BaseModel):
    """A dense path in m, map frame: `clearance` is its least distance to what is not free."""

    points: list[Point]
    length: float
    clearance: float


class RouteAnswer(BaseModel):
    """A route; `points` are its start, its passage points and its goal, `length` is in m.

    `cost` is what the costs of a metre and a passage, and restrictions, make of it.
    """

    source: str
    target: str
    zones: list[str]
    passages: list[RoutePassage]
    points: list[Point]
    length: float
    cost: float
    path: PathAnswer | None = None


class RoutesAnswer(RouteAnswer):
    """The best route, and others, where more than one was asked for."""

    alternatives: list[RouteAnswer] | None = None
