"""Maps: the graph, and the zones as GeoJSON."""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel

from semtopo.types import Point


class GraphNode(BaseModel):
    """A zone in the graph."""

    id: str
    label: str


class GraphEdge(BaseModel):
    """A directed edge; `seq` is the step that found it, `n` its number, where not 0."""

    source: str
    target: str
    point: Point
    n: int | None = None
    seq: int


class GraphSizes(BaseModel):
    """How many nodes and edges a graph has."""

    nodes: int
    edges: int


class GraphAnswer(BaseModel):
    """The topology graph after step `seq`; with `since` what changed, and `total`, of all."""

    seq: int
    total: GraphSizes | None = None
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
    """The metric map after step `seq`, as GeoJSON; `total` as in the graph."""

    type: Literal["FeatureCollection"]
    seq: int
    total: int | None = None
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
    """The borders of all zones after step `seq`, as GeoJSON; `total` counts zones."""

    type: Literal["FeatureCollection"]
    seq: int
    total: int | None = None
    features: list[BorderFeature]


class DoorwayProperties(BaseModel):
    """About a doorway: the zones at its ends, and which of those between them it is; m^2."""

    ends: tuple[str, str]
    number: int
    area: float
    since: int
    seq: int


class DoorwayFeature(BaseModel):
    """A doorway as a GeoJSON feature."""

    type: Literal["Feature"]
    geometry: PolygonAnswer | MultiPolygonAnswer
    properties: DoorwayProperties


class DoorwaysAnswer(BaseModel):
    """The doorways of a map after step `seq`, as GeoJSON."""

    type: Literal["FeatureCollection"]
    seq: int
    total: int | None = None
    features: list[DoorwayFeature]
