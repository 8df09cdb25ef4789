"""What a page needs to follow a robot."""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel

from semtopo.documents import PoseDocument
from semtopo.types import Point
from service.schemas.steps import EdgeEvent, NodeEvent


class SightAnswer(BaseModel):
    """What the robot saw at step `seq`: where each beam ended, and why; m, map frame."""

    seq: int
    pose: PoseDocument | None
    ends: list[Point]
    occupancy: list[Literal["none", "free", "passage", "obstacle"]]


class TrailChange(BaseModel):
    """A step that found something."""

    seq: int
    here: str | None
    events: list[NodeEvent | EdgeEvent]


class TrailAnswer(BaseModel):
    """Where the robot was: x, y, theta of each step from `first` on; `next` is as of the log."""

    first: int
    poses: list[tuple[float, float, float]]
    changes: list[TrailChange]
    next: int | None
