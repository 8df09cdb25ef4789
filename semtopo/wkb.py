"""Zones as bytes, exact: what a database keeps of them.

Regions are well-known binary (WKB); border points are plain arrays.
"""

from __future__ import annotations

import numpy as np
import shapely

from semtopo.core import Core
from semtopo.errors import InvalidMapError
from semtopo.geometry import Region
from semtopo.metric import MappedZone
from semtopo.zones import Border

POINT_BYTES = 17
"""A stored border point: two floats of 8 bytes, and one occupancy."""


def shape_bytes(zone: MappedZone) -> tuple[bytes, bytes]:
    """Return the region and the border points of a zone as bytes, exact, with its core if any.

    With a core, the first are both regions as a WKB collection, and the second are the tolerance
    (a 64-bit float) and the border points of the core.
    """
    core = zone.core
    if core is None:
        return region_bytes(zone.region), border_bytes(zone.border)
    both = shapely.GeometryCollection([zone.region, core.region])
    return shapely.to_wkb(both), np.array(core.tolerance, dtype="<f8").tobytes() + border_bytes(
        core.border
    )


def shape_from(region: bytes, border: bytes) -> tuple[Region, Border, Core | None]:
    """Read region, border points and core of a zone back from `shape_bytes`."""
    if len(border) % POINT_BYTES == 0:
        return region_from(region), border_from(border), None
    reduced, whole = shapely.get_parts(shapely.from_wkb(region))
    tolerance = np.frombuffer(border, dtype="<f8", count=1)[0]
    core = Core(whole, border_from(border[8:]), float(tolerance))
    return reduced, core.border.on(reduced), core


def region_bytes(region: Region) -> bytes:
    """Return a region as well-known binary (WKB), exact."""
    return shapely.to_wkb(region)


def region_from(stored: bytes) -> Region:
    """Read a region back from `region_bytes`."""
    region = shapely.from_wkb(stored)
    if not isinstance(region, Region):
        raise InvalidMapError("a stored region is no polygon")
    return region


def border_bytes(border: Border) -> bytes:
    """Return border points as bytes: all x and y (64-bit floats), then all occupancies (bytes)."""
    return border.xy.astype("<f8").tobytes() + border.occupancy.tobytes()


def border_from(stored: bytes) -> Border:
    """Read border points back from `border_bytes`."""
    count = len(stored) // POINT_BYTES
    xy = np.frombuffer(stored, dtype="<f8", count=2 * count).reshape(-1, 2)
    return Border(xy, np.frombuffer(stored, dtype=np.uint8, offset=16 * count))
