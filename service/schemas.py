"""The bodies of requests and answers, as HTTP and OpenAPI see them.

Requests are built from the library's documents. Answers are described here, and written elsewhere,
as bytes; tests hold the two together.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, BeforeValidator, Field

from semtopo.documents import (
    Document,
    Label,
    MappingDocument,
    PoseDocument,
    ScanDocument,
    SensorDocument,
    WorldDocument,
)

SEQ_MAX = 2**31 - 1
TEXT_MAX = 2_000  # characters of a question
ZONES_MAX = 10_000  # of a world; the library and the command take more


def _few_zones(given: object) -> object:
    """Refuse a world of too many zones, before each is looked at."""
    zones = given.get("zones") if isinstance(given, dict) else None
    if isinstance(zones, list) and len(zones) > ZONES_MAX:
        raise ValueError(f"a world has at most {ZONES_MAX} zones")
    return given


class SessionRequest(Document):
    """A new session: with a world, its sensor is simulated; without one, steps bring scans."""

    name: Label | None = None
    world: Annotated[WorldDocument | None, BeforeValidator(_few_zones)] = None
    sensor: SensorDocument = SensorDocument()
    mapping: MappingDocument = MappingDocument()


class StepDocument(Document):
    """A step: where the robot is, what it sees, and which of its steps this is."""

    pose: PoseDocument
    scan: ScanDocument | None = None
    seq: Annotated[int, Field(strict=True, ge=1, le=SEQ_MAX)] | None = None


class QueryRequest(Document):
    """A question in words."""

    text: Annotated[str, Field(strict=True, min_length=1, max_length=TEXT_MAX)]


class WorldSummary(BaseModel):
    """A session's world in brief."""

    name: str
    zones: int


class SessionAnswer(BaseModel):
    """A session."""

    id: str
    name: str
    created_at: str
    seq: int
    sensor: SensorDocument
    mapping: MappingDocument
    world: WorldSummary | None


class SessionListed(BaseModel):
    """A session in a listing."""

    id: str
    name: str
    created_at: str
    seq: int


class SessionsAnswer(BaseModel):
    """A page of sessions; `next` is the cursor of the page that follows, if one does."""

    sessions: list[SessionListed]
    next: str | None


Point = tuple[float, float]


class NodeEvent(BaseModel):
    """A step found a zone."""

    type: Literal["node"]
    label: str
    zone_id: str


class EdgeEvent(BaseModel):
    """A step found a passage; its point is in m, map frame."""

    type: Literal["edge"]
    source: str
    target: str
    point: Point


class Timings(BaseModel):
    """How long the stages of a step took, in ms (Table 1 of the paper)."""

    measurement: float
    analysis: float
    extraction: float
    map_update: float
    graph_update: float
    total: float


class StepAnswer(BaseModel):
    """What a step led to."""

    seq: int
    here: str | None
    events: list[NodeEvent | EdgeEvent]
    timings_ms: Timings


class GraphNode(BaseModel):
    """A zone in the graph."""

    id: str
    label: str


class GraphEdge(BaseModel):
    """A directed edge; `seq` is the step that found it."""

    source: str
    target: str
    point: Point
    seq: int


class GraphAnswer(BaseModel):
    """The topology graph after step `seq`."""

    seq: int
    nodes: list[GraphNode]
    edges: list[GraphEdge]


class PolygonAnswer(BaseModel):
    """A polygon: outer ring first, then holes; m, map frame."""

    type: Literal["Polygon"]
    coordinates: list[list[Point]]


class MultiPolygonAnswer(BaseModel):
    """Several polygons of one zone."""

    type: Literal["MultiPolygon"]
    coordinates: list[list[list[Point]]]


class ZoneProperties(BaseModel):
    """About a zone: area in m^2, the step that found it, the last step that changed it."""

    label: str
    area: float
    since: int
    seq: int


class ZoneFeature(BaseModel):
    """A zone as a GeoJSON feature."""

    type: Literal["Feature"]
    id: str
    geometry: PolygonAnswer | MultiPolygonAnswer
    properties: ZoneProperties


class ZonesAnswer(BaseModel):
    """The metric map after step `seq`, as GeoJSON."""

    type: Literal["FeatureCollection"]
    seq: int
    features: list[ZoneFeature]


class LineAnswer(BaseModel):
    """A line of two points or more; m, map frame."""

    type: Literal["LineString"]
    coordinates: list[Point]


class BorderProperties(BaseModel):
    """Of which zone a stretch of border is, and what is there; at `free` the unknown begins."""

    zone_id: str
    occupancy: Literal["obstacle", "passage", "free"]


class BorderFeature(BaseModel):
    """A stretch of a zone's border as a GeoJSON feature."""

    type: Literal["Feature"]
    geometry: LineAnswer
    properties: BorderProperties


class BordersAnswer(BaseModel):
    """The borders of all zones after step `seq`, as GeoJSON."""

    type: Literal["FeatureCollection"]
    seq: int
    features: list[BorderFeature]


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


class RoutePassage(BaseModel):
    """A passage on a route."""

    source: str
    target: str
    point: Point


class RouteAnswer(BaseModel):
    """A route; `length` in m along its passage points."""

    source: str
    target: str
    zones: list[str]
    passages: list[RoutePassage]
    length: float


class QueryAnswer(BaseModel):
    """The answer to a question."""

    kind: Literal["path"]
    sentence: str
    route: RouteAnswer


class HealthAnswer(BaseModel):
    """The service is well."""

    status: Literal["ok"]


class Mistake(BaseModel):
    """One mistake in a request."""

    at: list[str]
    what: str


class ProblemAnswer(BaseModel):
    """An error (RFC 9457); programs may depend on `code`."""

    type: str
    title: str
    status: int
    code: str
    detail: str
    errors: list[Mistake] | None = None
    expected: int | None = None


def problems(*statuses: int) -> dict[int | str, dict[str, Any]]:
    """Return the OpenAPI responses for errors of these statuses."""
    return {status: {"model": ProblemAnswer} for status in statuses}
