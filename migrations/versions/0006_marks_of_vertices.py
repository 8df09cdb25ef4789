"""Keep a mark for each vertex of a border, instead of border points with their places.

The low two bits of a mark are the occupancy of the vertex, the next two that of the side from it
to the next. Rings keep the region on their left, and vertices stand as in the WKB.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import shapely
import sqlalchemy as sa
from alembic import op
from numpy.typing import NDArray
from shapely.geometry.base import BaseGeometry

revision = "0006"
down_revision = "0005"
branch_labels = None
depends_on = None

POINT_BYTES = 17
TOLERANCE_BYTES = 8

KEYS = {"zones": ("session", "zone_id"), "zone_versions": ("session", "zone_id", "checkpoint")}

Convert = Callable[[bytes, bytes], tuple[bytes, bytes]]


def upgrade() -> None:
    _convert(_with_marks)


def downgrade() -> None:
    _convert(_with_points)


def _convert(convert: Convert) -> None:
    """Rewrite region and border of every row, one at a time."""
    connection = op.get_bind()
    for name, columns in KEYS.items():
        table = sa.table(name, *map(sa.column, (*columns, "region", "border")))
        keys = [table.c[column] for column in columns]
        for row in connection.execute(sa.select(*keys)).all():
            here = sa.and_(*(key == value for key, value in zip(keys, row, strict=True)))
            shape = sa.select(table.c.region, table.c.border).where(here)
            region, border = connection.execute(shape).one()
            if region:
                new = dict(zip(("region", "border"), convert(region, border), strict=True))
                connection.execute(sa.update(table).where(here).values(new))


def _parts(region: bytes, border: bytes) -> tuple[BaseGeometry, BaseGeometry, bytes, bytes]:
    """Return all of a stored shape, the region that the border is of, the tolerance, the border."""
    whole = shapely.orient_polygons(shapely.from_wkb(region))
    if isinstance(whole, shapely.GeometryCollection):
        return whole, whole.geoms[1], border[:TOLERANCE_BYTES], border[TOLERANCE_BYTES:]
    return whole, whole, b"", border


def _with_marks(region: bytes, border: bytes) -> tuple[bytes, bytes]:
    whole, bordered, tolerance, points = _parts(region, border)
    count = len(points) // POINT_BYTES
    xy = np.frombuffer(points, dtype="<f8", count=2 * count).reshape(-1, 2)
    why = np.frombuffer(points, dtype=np.uint8, offset=16 * count)
    known = dict(zip(map(tuple, xy.tolist()), why.tolist(), strict=True))
    marks = [_marks(ring, known) for ring in shapely.get_rings(shapely.get_parts(bordered))]
    return shapely.to_wkb(whole), tolerance + b"".join(it.tobytes() for it in marks)


def _marks(ring: BaseGeometry, known: dict[tuple[float, ...], int]) -> NDArray[np.uint8]:
    """Return the marks of a closed ring: along a side, the lesser of two occupancies holds."""
    xy = shapely.get_coordinates(ring).tolist()
    why = np.array([known.get(tuple(place), 0) for place in xy], dtype=np.uint8)
    after = np.append(why[1:], why[1:2])
    sides = np.where(why == 0, after, np.where(after == 0, why, np.minimum(why, after)))
    marks: NDArray[np.uint8] = (why + 4 * np.maximum(sides, 1)).astype(np.uint8)
    return marks


def _with_points(region: bytes, border: bytes) -> tuple[bytes, bytes]:
    whole, bordered, tolerance, marks = _parts(region, border)
    why = np.frombuffer(marks, dtype=np.uint8) & 3
    xy = shapely.get_coordinates(bordered)[why > 0]
    return shapely.to_wkb(whole), tolerance + xy.astype("<f8").tobytes() + why[why > 0].tobytes()
