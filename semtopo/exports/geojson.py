"""Borders, doorways and whole maps as GeoJSON (RFC 7946, but for the frame)."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
import orjson
import shapely

from semtopo.borders import BorderPiece, PiecedBorder, border_pieces, reduced
from semtopo.codec import (
    Document,
    changed_since,
    collection,
    region_document,
    to_json,
    zone_feature,
    zones_in,
)
from semtopo.doorways import Doorway, DoorwayKey, Doorways
from semtopo.errors import InvalidMapError
from semtopo.exports.chart import Chart
from semtopo.fusion import Extent
from semtopo.geometry import Box, Region, polygonal
from semtopo.graph import Passage
from semtopo.mapper import MapState
from semtopo.metric import MappedZone
from semtopo.types import Occupancy

NUMBER_MAX = 10_000
"""Of a doorway that is read back: so many between two zones are no map."""


def borders_body(
    state: MapState, box: Box | None = None, tolerance: float = 0.0, since: int | None = None
) -> bytes:
    """Return the borders of all zones, piece by piece: walls, passages and frontiers.

    A frontier is a piece with occupancy `free`. With `box`, in m: of the zones that meet it. Lines
    have no more points than it takes to stay within `tolerance`, in m. With `since`: of the zones
    that a later step changed; `total` counts the zones.
    """
    zones = zones_in(state, box)
    features = _borders_of(changed_since(zones, since), tolerance)
    return to_json(collection(state.seq, features, None if since is None else len(zones)))


def doorways_body(
    state: MapState, box: Box | None = None, tolerance: float = 0.0, since: int | None = None
) -> bytes:
    """Return the doorways of a map: the free ground between two zones, which belongs to neither.

    With `box`, in m: those that meet it. Outlines are as those of `borders_body`. With `since`:
    those that a later step changed, and `total`, how many there are.
    """
    found = list(state.metric.doorways.values())
    if box is not None:
        window = shapely.box(*box)
        found = [doorway for doorway in found if doorway.region.intersects(window)]
    features = [_doorway(doorway, tolerance) for doorway in changed_since(found, since)]
    return to_json(collection(state.seq, features, None if since is None else len(found)))


def _doorway(doorway: Doorway, tolerance: float = 0.0) -> Document:
    """Return a doorway; it is named by its ends and number."""
    region: Region = shapely.orient_polygons(doorway.region)  # as it is read back: area is a sum
    outline = shapely.simplify(region, tolerance) if tolerance else region
    return {
        "type": "Feature",
        "geometry": region_document(polygonal(outline)),
        "properties": {
            "ends": doorway.ends,
            "number": doorway.number,
            "area": region.area,
            "since": doorway.since,
            "seq": doorway.seq,
        },
    }


def read_doorways(body: bytes) -> Doorways:
    """Read doorways back from `doorways_body`.

    Where a number is missing, that one became part of another: which, the body does not tell, so it
    is said to be the first between the same zones.

    Raises
    ------
    InvalidMapError
        The body is none that this module wrote.
    """
    known = {it.key: it for it in (_doorway_from(feature) for feature in _features(body))}
    former: dict[DoorwayKey, DoorwayKey] = {}
    for one, other, number in known:
        before = [(one, other, lower) for lower in range(number)]
        former.update({key: (one, other, 0) for key in before if key not in known})
    return Doorways(known, former)


def read_borders(body: bytes) -> list[Document]:
    """Read the features of `borders_body` back; raises as `read_doorways` does."""
    found = _features(body)
    if any("occupancy" not in _properties(feature) for feature in found):
        raise InvalidMapError("these are not the borders of a map")
    return found


def bordered(state: MapState, borders: Iterable[Document]) -> MapState:
    """Return a map with the borders that `read_borders` read.

    Raises
    ------
    InvalidMapError
        They are not the borders of its zones.
    """
    pieces: dict[str, list[BorderPiece]] = {}
    try:
        for feature in borders:
            about, (one, other, *more) = feature["properties"], feature["geometry"]["coordinates"]
            line = np.array([one, other, *more], dtype=np.float64).reshape(-1, 2)
            piece = BorderPiece(Occupancy[about["occupancy"].upper()], line)
            pieces.setdefault(about["zone_id"], []).append(piece)
        zones = dict(state.metric.zones)
        for zone_id, found in pieces.items():
            zone = zones[zone_id]
            border = PiecedBorder.of_pieces(zone.border, found)
            zones[zone_id] = replace(zone, extent=Extent(border, zone.region))
    except (LookupError, TypeError, ValueError, AttributeError) as error:
        raise InvalidMapError("these are not the borders of the map") from error
    return replace(state, metric=replace(state.metric, zones=zones))


def _features(body: bytes) -> list[Document]:
    """Return the features of a collection."""
    try:
        found = orjson.loads(body)["features"]
    except (LookupError, TypeError, ValueError) as error:
        raise InvalidMapError("this is no collection of features") from error
    if not isinstance(found, list) or not all(isinstance(it, dict) for it in found):
        raise InvalidMapError("this is no collection of features")
    return found


def _properties(feature: Document) -> Document:
    properties = feature.get("properties")
    return properties if isinstance(properties, dict) else {}


def _doorway_from(feature: Document) -> Doorway:
    about = _properties(feature)
    try:
        region = shapely.from_geojson(orjson.dumps(feature["geometry"]))
        one, other = about["ends"]
        seen = (int(about["since"]), int(about["seq"]))
        number = range(NUMBER_MAX)[int(about["number"])]
        doorway = Doorway((str(one), str(other)), number, polygonal(region), *seen)
    except (LookupError, TypeError, ValueError, shapely.errors.ShapelyError) as error:
        raise InvalidMapError("these are not the doorways of a map") from error
    return doorway


def geojson_body(chart: Chart) -> bytes:
    """Return all of a map in one collection: the property `layer` says what a feature is.

    Zones, doorways, passages (points) and frontiers (lines), in that order.
    """
    state = chart.state
    layers: dict[str, Iterable[Document]] = {
        "zone": map(zone_feature, state.metric.zones.values()),
        "doorway": map(_doorway, state.metric.doorways.values()),
        "passage": map(_passage, state.graph.passages.values()),
        "frontier": (it for it in chart.borders if it["properties"]["occupancy"] == "free"),
    }
    features = [_of_layer(layer, it) for layer, found in layers.items() for it in found]
    return to_json(collection(state.seq, features))


def border_features(
    state: MapState, box: Box | None = None, tolerance: float = 0.0
) -> list[Document]:
    """Return what `borders_body` holds."""
    return _borders_of(zones_in(state, box), tolerance)


def _borders_of(zones: Iterable[MappedZone], tolerance: float) -> list[Document]:
    found = [(zone.zone_id, piece) for zone in zones for piece in border_pieces(zone)]
    pieces = [piece for _, piece in found]
    drawn = reduced(pieces, tolerance) if tolerance else pieces
    return [_border(zone_id, piece) for (zone_id, _), piece in zip(found, drawn, strict=True)]


def _of_layer(layer: str, feature: Document) -> Document:
    return {**feature, "properties": {"layer": layer, **feature["properties"]}}


def _passage(passage: Passage) -> Document:
    """Return a passage; it is a point, on the border of the zone to which it leads."""
    return {
        "type": "Feature",
        "geometry": {"type": "Point", "coordinates": passage.point},
        "properties": {
            "source": passage.source,
            "target": passage.target,
            "number": passage.number,
            "seq": passage.seq,
        },
    }


def _border(zone_id: str, piece: BorderPiece) -> Document:
    """Return a stretch of a border; it is closed where its ends are the same."""
    return {
        "type": "Feature",
        "geometry": {"type": "LineString", "coordinates": piece.line},
        "properties": {"zone_id": zone_id, "occupancy": piece.occupancy.name.lower()},
    }
