"""What a session takes: memory of a real server, bytes on disk, and bytes of the map.

One session takes 10,000 steps over HTTP, wandering in the paper's world at 72 beams. Another has
warmed the server up before, so that what each process needs once is not counted as the session's.
The map is compared with an occupancy grid of the same area, drawn from the map.
"""

from __future__ import annotations

import gzip
import io
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import orjson
import shapely
from PIL import Image
from shapely.geometry import shape
from shapely.geometry.base import BaseGeometry

from benchmarks.load import request_bytes, run
from benchmarks.paper import EXAMPLE, wander
from benchmarks.table import Row, Table, skipped
from semtopo.types import Bytes
from service.database import sqlite_driver
from tests.servers import Server

TOLERANCES = (0.0, 0.02, 0.05)
STEPS = 10_000
WARM_STEPS = 100
CELL = 0.05
"""m; of the occupancy grid."""

FREE, OCCUPIED, UNKNOWN = 0, 1, 2
PALETTE = (254, 254, 254, 0, 0, 0, 205, 205, 205)
"""Red, green and blue of each, as ROS draws them."""

LOG = "SELECT sum(length(input) + length(answer) + length(fingerprint)) FROM steps"
EARLIER = (
    "SELECT sum(length(region) + length(border)) FROM zone_versions",
    "SELECT sum(length(region)) FROM doorway_versions",
)
SHAPES = "SELECT region, border FROM zones"
POINTS = "SELECT x, y FROM passages"
"""What is stored of the newest session, not counting what SQLite needs to find it."""


def held_mb(server: Server, what: str = "VmRSS") -> float:
    """Return how much memory a server's process holds, or (VmHWM) held at most, in MB."""
    lines = Path(f"/proc/{server.pid}/status").read_text().splitlines()
    return next(int(line.split()[1]) * 1024 / 1e6 for line in lines if line.startswith(what))


def new_session(server: Server, tolerance: float) -> str:
    """Begin a session in the paper's world, and return its path."""
    world = orjson.loads((EXAMPLE / "world.json").read_bytes())
    return server.create(world=world, mapping={"tolerance": tolerance})


def take_steps(server: Server, session: str, count: int) -> None:
    """Wander."""
    bodies = [orjson.dumps({"pose": {"x": x, "y": y}}) for x, y in wander(count)]
    target = f"{session}/step"
    requests = [request_bytes("POST", target, body) for body in bodies]
    run(server.port, lambda number: requests[number], clients=1, count=count)


def grid_cells(zones: list[BaseGeometry], walls: list[BaseGeometry]) -> Bytes:
    """Return the area of zones and doorways as cells, from low to high x (columns) and y (rows)."""
    free = shapely.union_all(zones)
    low_x, low_y, high_x, high_y = free.buffer(2 * CELL).bounds
    x, y = np.arange(low_x, high_x, CELL), np.arange(low_y, high_y, CELL)
    shapely.prepare(free)
    inside = shapely.contains_xy(free, *np.meshgrid(x + CELL / 2, y + CELL / 2))
    cells = np.where(inside, np.uint8(FREE), np.uint8(UNKNOWN))
    xy = shapely.get_coordinates(shapely.segmentize(walls, CELL / 4))
    column, row = ((xy - (low_x, low_y)) // CELL).astype(int).T
    cells[row, column] = OCCUPIED
    return cells


def grid_png(cells: Bytes) -> bytes:
    """Return cells as a PNG of two bits a cell, y upwards."""
    image = Image.fromarray(cells[::-1]).convert("P")
    image.putpalette(PALETTE)
    file = io.BytesIO()
    image.save(file, "PNG", bits=2, optimize=True)
    return file.getvalue()


def drawn_grid(server: Server, session: str) -> bytes:
    """Return the map of a session as an occupancy grid, drawn from what the service tells of it."""
    zones, doorways, borders = (
        orjson.loads(server.get(f"{session}/{name}"))["features"]
        for name in ("zones", "doorways", "borders")
    )
    known = [shape(it["geometry"]) for it in [*zones, *doorways]]
    is_wall = [it["properties"]["occupancy"] == "obstacle" for it in borders]
    lines = [shape(it["geometry"]) for it in borders]
    walls = [line for line, wall in zip(lines, is_wall, strict=True) if wall]
    return grid_png(grid_cells(known, walls))


def newest(server: Server, query: str) -> list[tuple[Any, ...]]:
    """Return rows of the newest session from a server's file."""
    connection = sqlite_driver().connect(server.database)
    found: list[tuple[Any, ...]] = connection.execute(
        f"{query} WHERE session = (SELECT max(number) FROM sessions)"  # noqa: S608 -- those above
    ).fetchall()
    connection.close()
    return found


def map_row(server: Server, session: str, tolerance: float) -> Row:
    """Return how many bytes the map takes, beside an occupancy grid."""
    zones, graph = (server.get(f"{session}/{name}") for name in ("zones", "graph"))
    grid = len(drawn_grid(server, session))
    vertices = sum(
        shapely.get_num_coordinates(shape(it["geometry"])) for it in orjson.loads(zones)["features"]
    )
    stored = b"".join(it for row in newest(server, SHAPES) for it in row)
    stored += np.array(newest(server, POINTS)).tobytes()
    sizes = {"GeoJSON and graph": zones + graph, "stored": stored}
    row = {"tolerance, m": f"{tolerance}", "vertices": str(vertices)}
    for name, body in sizes.items():
        row[f"{name}, bytes"] = f"{len(body):,}"
        row[f"{name}, gzip"] = f"{len(gzip.compress(body, 9, mtime=0)):,}"
    zipped = len(gzip.compress(zones + graph, 9, mtime=0))
    return row | {"grid PNG, bytes": f"{grid:,}", "grid / GeoJSON, gzip": f"{grid / zipped:.1f}"}


def session_row(server: Server, tolerance: float) -> tuple[Row, Row]:
    """Take all steps in a new session; return what it took, and what its map takes."""
    take_steps(server, new_session(server, tolerance), WARM_STEPS)
    session = new_session(server, tolerance)
    empty = held_mb(server, "VmHWM")
    take_steps(server, session, STEPS)
    server.get(f"{session}/zones")
    peak = held_mb(server, "VmHWM") - empty
    map_sizes = map_row(server, session, tolerance)
    server.stop()  # which brings the write-ahead log into the file
    written = server.database.stat().st_size / (WARM_STEPS + STEPS)
    log, *earlier = (newest(server, query)[0][0] or 0 for query in (LOG, *EARLIER))
    row = {
        "tolerance, m": f"{tolerance}", "peak over an empty session, MB": f"{peak:.1f}",
        "bytes on disk a step": f"{written:.0f}", "of these, log": f"{log / STEPS:.0f}",
        "of these, earlier maps": f"{sum(earlier) / STEPS:.0f}",
    }  # fmt: skip
    return row, map_sizes


def tables() -> Iterator[Table]:
    """Yield what sessions take in memory and on disk, and what their maps take."""
    title = f"A session of {STEPS:,} steps over HTTP, 72 beams, SQLite"
    if sys.platform != "linux":
        yield skipped(title, "memory is read from /proc, as Linux has it")
        return
    rows = []
    for tolerance in TOLERANCES:
        with tempfile.TemporaryDirectory() as folder:
            server = Server(Path(folder))
            server.start()
            rows.append(session_row(server, tolerance))
            server.close()
    yield title, [row for row, _ in rows]
    yield f"Its map in bytes, and an occupancy grid of {CELL} m", [row for _, row in rows]
