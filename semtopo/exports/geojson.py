"""Features of a map as GeoJSON (RFC 7946, but for the frame): what lies on the borders of zones."""

from __future__ import annotations

from collections.abc import Iterator

from semtopo.borders import BorderPiece, border_pieces
from semtopo.codec import Document, to_json
from semtopo.mapper import MapState


def borders_body(state: MapState) -> bytes:
    """Return the borders of all zones, piece by piece: walls, passages and frontiers.

    A frontier is a piece with occupancy `free`.
    """
    return _collection(state, _borders(state))


def _collection(state: MapState, features: Iterator[Document]) -> bytes:
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
