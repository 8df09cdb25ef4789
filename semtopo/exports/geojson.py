"""Borders and doorways of a map as GeoJSON (RFC 7946, but for the frame)."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from semtopo.borders import BorderPiece, border_pieces
from semtopo.codec import Document, region_document, to_json
from semtopo.doorways import Doorway
from semtopo.mapper import MapState


def borders_body(state: MapState) -> bytes:
    """Return the borders of all zones, piece by piece: walls, passages and frontiers.

    A frontier is a piece with occupancy `free`.
    """
    return _collection(state, _borders(state))


def doorways_body(state: MapState) -> bytes:
    """Return the doorways of a map: the free ground between two zones, which belongs to neither."""
    return _collection(state, map(_doorway, state.metric.doorways.values()))


def _doorway(doorway: Doorway) -> Document:
    """Return a doorway; it is named by its ends and number."""
    return {
        "type": "Feature",
        "geometry": region_document(doorway.region),
        "properties": {
            "ends": doorway.ends,
            "number": doorway.number,
            "area": doorway.region.area,
            "since": doorway.since,
            "seq": doorway.seq,
        },
    }


def _collection(state: MapState, features: Iterable[Document]) -> bytes:
    return to_json({"type": "FeatureCollection", "seq": state.seq, "features": list(features)})


def _borders(state: MapState) -> Iterator[Document]:
    for zone_id, zone in state.metric.zones.items():
        for piece in border_pieces(zone):
            yield _border(zone_id, piece)


def _border(zone_id: str, piece: BorderPiece) -> Document:
    """Return a stretch of a border; it is closed where its ends are the same."""
    return {
        "type": "Feature",
        "geometry": {"type": "LineString", "coordinates": piece.line},
        "properties": {"zone_id": zone_id, "occupancy": piece.occupancy.name.lower()},
    }
