"""Zones as bytes, exact: what a database keeps of them.

Regions are well-known binary (WKB); what is known of their borders is one byte for each vertex.
"""

from __future__ import annotations

import numpy as np
import shapely

from semtopo.border import Border
from semtopo.core import Core
from semtopo.errors import InvalidMapError
from semtopo.fusion import Extent
from semtopo.geometry import Region
from semtopo.metric import MappedZone
from semtopo.traced import traced


def shape_bytes(zone: MappedZone) -> tuple[bytes, bytes]:
    """Return the region of a zone and what is known of its border as bytes, exact.

    With a core, the first are both regions as a WKB collection, and the second are the tolerance
    (a 64-bit float) and the marks of the core.
    """
    core = zone.core
    if core is None:
        return region_bytes(zone.region), zone.border.marks.tobytes()
    both = shapely.GeometryCollection([zone.region, core.region])
    tolerance = np.array(core.tolerance, dtype="<f8").tobytes()
    return shapely.to_wkb(both), tolerance + core.border.marks.tobytes()


def shape_from(stored: bytes, marks: bytes) -> tuple[Extent, Core | None]:
    """Read extent and core of a zone back from `shape_bytes`."""
    region = shapely.from_wkb(stored)
    if isinstance(region, Region):
        return _extent(region, marks), None
    parts = shapely.get_parts(region)
    if len(parts) != 2:  # noqa: PLR2004 -- the reduced region and that of the core
        raise InvalidMapError("a stored region is no polygon")
    reduced, whole = parts
    tolerance = np.frombuffer(marks, dtype="<f8", count=1)[0]
    core = Core(_extent(whole, marks[8:]), float(tolerance))
    return Extent(traced(reduced, [core.border]), reduced), core


def _extent(region: Region, marks: bytes) -> Extent:
    """Return a region whose vertices have marks."""
    return Extent(Border.of(region, np.frombuffer(marks, dtype=np.uint8)), region)


def region_bytes(region: Region) -> bytes:
    """Return a region as well-known binary (WKB), exact."""
    return shapely.to_wkb(region)


def region_from(stored: bytes) -> Region:
    """Read a region back from `region_bytes`."""
    region = shapely.from_wkb(stored)
    if not isinstance(region, Region):
        raise InvalidMapError("a stored region is no polygon")
    return region
