"""Steps: what comes in, what is answered, and how the log tells of them."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, Field

from semtopo.documents import Document, PoseDocument, ScanDocument
from semtopo.types import Point

SEQ_MAX = 2**31 - 1


class StepDocument(Document):
    """A step: where the robot is, what it sees, and which of its steps this is."""

    pose: PoseDocument
    scan: ScanDocument | None = None
    seq: Annotated[int, Field(strict=True, ge=1, le=SEQ_MAX)] | None = None


class NodeEvent(BaseModel):
    """A step found a zone."""

    type: Literal["node"]
    label: str
    zone_id: str


class EdgeEvent(BaseModel):
    """A step found a passage; its point is in m, map frame. `n` is its number, where not 0."""

    type: Literal["edge"]
    source: str
    target: str
    point: Point
    n: int | None = None


class MergeEvent(BaseModel):
    """A zone proved to be part of another: its passages are now those of zone `into`."""

    type: Literal["merge"]
    zone_id: str
    into: str


class JoinEvent(BaseModel):
    """A passage proved to be the one with number `into` between the same zones."""

    type: Literal["join"]
    source: str
    target: str
    n: int
    into: int


class Timings(BaseModel):
    """How long the stages of a step took, in ms (Table 1 of the paper)."""

    measurement: float
    analysis: float
    extraction: float
    map_update: float
    graph_update: float
    total: float


class StepAnswer(BaseModel):
    """What a step led to; `here` is the label of the zone where the robot is, `zone_id` its id."""

    seq: int
    here: str | None
    zone_id: str | None
    events: list[NodeEvent | EdgeEvent | MergeEvent | JoinEvent]
    timings_ms: Timings


class LoggedInput(BaseModel):
    """What a step brought."""

    pose: PoseDocument
    scan: ScanDocument | None = None


class StepListed(BaseModel):
    """A step in the log: what came in and what was answered."""

    seq: int
    taken_at: str
    input: LoggedInput
    answer: StepAnswer


class StepsAnswer(BaseModel):
    """A page of the log; `next` is the `after` of the page that follows, if one does."""

    steps: list[StepListed]
    next: int | None
