"""Maps, steps and routes as bytes: the bodies of HTTP, the files of the command line, stored rows.

Every number is written so that it reads back to the very same value. Coordinates are in m, map
frame; polygons follow RFC 7946 (GeoJSON), but for the frame.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import asdict, fields, is_dataclass
from typing import Any, TypeAlias, TypeVar

import orjson
import shapely
from shapely import Polygon

from semtopo.answers import Answer
from semtopo.atlas import Limits
from semtopo.doorways import Doorway
from semtopo.geometry import Box, Region
from semtopo.graph import (
    Event,
    Node,
    NodeFound,
    NodeMerged,
    Passage,
    PassageFound,
    PassageJoined,
    TopologyGraph,
)
from semtopo.mapper import MapState, Step
from semtopo.metric import MappedZone
from semtopo.notes import ZoneNotes
from semtopo.route import Route

Document: TypeAlias = dict[str, Any]
"""What orjson can write: a JSON object, numpy arrays among it."""

Dated = TypeVar("Dated", Node, MappedZone, Doorway)


def to_json(document: Document) -> bytes:
    """Return a document as JSON, in the one form used everywhere."""
    return orjson.dumps(document, option=orjson.OPT_SERIALIZE_NUMPY)


def zones_body(
    state: MapState,
    box: Box | None = None,
    notes: Mapping[str, ZoneNotes] | None = None,
    since: int | None = None,
) -> bytes:
    """Return the zones of a map, those that meet `box` if there is one, as GeoJSON.

    What people call a zone is said where it was noted, and only there. With `since`, zones that
    were as they are after that step are left out.
    """
    zones = zones_in(state, box)
    features = [zone_feature(zone) for zone in changed_since(zones, since)]
    for feature in features if notes else ():
        feature["properties"] |= _noted(notes or {}, feature["id"])
    return to_json(collection(state.seq, features, None if since is None else len(zones)))


def collection(seq: int, features: list[Document], total: int | None = None) -> Document:
    """Return features of a map after step `seq`; where only some are told, `total` counts all.

    Whoever has those of step `since` adds what a later step changed. More than `total` of them are
    there then if, and only if, some are gone.
    """
    counted = {} if total is None else {"total": total}
    return {"type": "FeatureCollection", "seq": seq, **counted, "features": features}


def changed_since(items: Iterable[Dated], since: int | None) -> list[Dated]:
    """Return what a later step than `since` changed, in order; all if it is `None`."""
    return [it for it in items if since is None or it.seq > since]


def zones_in(state: MapState, box: Box | None) -> list[MappedZone]:
    """Return the zones of a map that meet `box`, in m, in the order of finding; else all."""
    zones = list(state.metric.zones.values())
    if box is None:
        return zones
    window = shapely.box(*box)
    return [zone for zone in zones if zone.region.intersects(window)]


def graph_body(
    graph: TopologyGraph,
    seq: int,
    notes: Mapping[str, ZoneNotes] | None = None,
    limits: Limits | None = None,
    since: int | None = None,
) -> bytes:
    """Return a graph as it is after step `seq`: nodes, and edges with their passage points.

    What is noted, closed or has a factor says so, and only that. With `since`, what was there after
    that step is left out, and `total` says how many there are, as in `collection`.
    """
    known, limit = notes or {}, limits or Limits()
    nodes = [
        {
            "id": node.zone_id,
            "label": node.label,
            **_noted(known, node.zone_id),
            **_limited(node.zone_id, limit.closed_zones, limit.zone_factors),
        }
        for node in changed_since(graph.nodes.values(), since)
    ]
    edges = [
        {
            **edge_document(edge),
            **_limited(edge.key, limit.closed_passages, limit.passage_factors),
        }
        for edge in graph.passages.values()
        if since is None or max(edge.seq, edge.moved) > since
    ]
    sizes = {"nodes": len(graph.nodes), "edges": len(graph.passages)}
    counted = {} if since is None else {"total": sizes}
    return to_json({"seq": seq, **counted, "nodes": nodes, "edges": edges})


def _noted(notes: Mapping[str, ZoneNotes], zone_id: str) -> Document:
    """Return what people call a zone: nothing where nothing is noted."""
    noted = notes.get(zone_id)
    if noted is None:
        return {}
    names = {"aliases": noted.aliases} if noted.aliases else {}
    return {**names, "class": noted.zone_class} if noted.zone_class is not None else names


def _limited(key: Any, closed: Collection[Any], factors: Mapping[Any, float]) -> Document:  # noqa: ANN401 -- a zone's key or a passage's
    """Return what holds for a zone or a passage: nothing where nothing restricts it."""
    factor = factors.get(key, 1.0)
    shut = {"closed": True} if key in closed else {}
    return {**shut, "factor": factor} if factor != 1 else shut


def edge_document(edge: Passage) -> Document:
    """Return an edge of a graph, with the step that found it."""
    return {**passage_document(edge), "seq": edge.seq}


def step_document(step: Step) -> Document:
    """Return what a step answers, but for the time that it took."""
    events = [event_document(event) for event in step.events]
    return {
        "seq": step.state.seq, "here": step.here, "zone_id": step.state.here, "events": events,
    }  # fmt: skip


def event_document(event: Event) -> Document:
    """Return one finding of a step."""
    match event:
        case NodeFound():
            return {"type": "node", "label": event.label, "zone_id": event.zone_id}
        case PassageFound():
            return {"type": "edge", **passage_document(event)}
        case NodeMerged():
            return {"type": "merge", "zone_id": event.zone_id, "into": event.into}
        case PassageJoined():
            ends = {"source": event.source, "target": event.target}
            return {"type": "join", **ends, "n": event.number, "into": event.into}


def passage_document(passage: Passage | PassageFound) -> Document:
    """Return a passage: its ends and its point, and `n`, its number, where that is not 0."""
    document = {"source": passage.source, "target": passage.target, "point": passage.point}
    return {**document, "n": passage.number} if passage.number else document


def route_document(route: Route) -> Document:
    """Return a route: its zones and passages, its length in m, its cost, its path if it has one."""
    used = zip(route.zones, route.passages, strict=False)
    passages = [
        {
            **passage_document(passage),
            **({} if passage.source == zone_id else {"backwards": True}),
        }
        for zone_id, passage in used
    ]
    document = {
        "source": route.source,
        "target": route.target,
        "zones": route.zones,
        "passages": passages,
        "points": route.points,
        "length": route.length,
        "cost": route.cost,
    }
    return document if route.path is None else {**document, "path": asdict(route.path)}


def answer_document(answer: Answer) -> Document:
    """Return the answer to a question, as structure and in words."""
    return {"kind": answer.kind, **_members(answer)}


def _members(value: Any) -> Document:  # noqa: ANN401 -- any part of an answer
    return {one.name: _document(getattr(value, one.name)) for one in fields(value)}


def _document(value: Any) -> Any:  # noqa: ANN401 -- any part of an answer
    """Return a part of an answer as what JSON has for it."""
    match value:
        case Route():
            return route_document(value)
        case Passage():
            return edge_document(value)
        case tuple():
            return [_document(one) for one in value]
        case _ if is_dataclass(value):
            return _members(value)
        case _:
            return value


def zone_feature(zone: MappedZone) -> Document:
    """Return one zone as a GeoJSON feature."""
    region: Region = shapely.orient_polygons(zone.region)  # as it is read back: area is a sum
    return {
        "type": "Feature",
        "id": zone.zone_id,
        "geometry": region_document(region),
        "properties": {
            "label": zone.label,
            "area": region.area,
            "since": zone.since,
            "seq": zone.seq,
        },
    }


def region_document(region: Region) -> Document:
    """Return a region as a GeoJSON geometry; outer rings counter-clockwise (RFC 7946, 3.1.6)."""
    turned: Region = shapely.orient_polygons(region)
    if isinstance(turned, Polygon):
        return {"type": "Polygon", "coordinates": _rings(turned)}
    return {"type": "MultiPolygon", "coordinates": [_rings(part) for part in turned.geoms]}


def _rings(polygon: Polygon) -> list[Any]:
    return [shapely.get_coordinates(ring) for ring in (polygon.exterior, *polygon.interiors)]
