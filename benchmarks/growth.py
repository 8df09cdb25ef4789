"""Whether a step grows with time: 10,000 steps of wandering in the paper's world."""

from __future__ import annotations

import io
import time
import tracemalloc
from collections.abc import Iterator

import numpy as np
import shapely
from PIL import Image

from benchmarks.paper import wander, world
from benchmarks.table import Table
from semtopo import MappingOptions, MapState, Sensor, explore, zones_body
from semtopo.geometry import count_vertices
from semtopo.metric import MetricMap
from semtopo.wkb import shape_bytes

STEPS = 10_000
MARKS = (1_000, 10_000)
TOLERANCES = (0.0, 0.02, 0.05)
CELL = 0.05
"""m; of the occupancy grid that the map is compared with."""

Run = tuple[list[float], dict[int, MapState], int]


def run(tolerance: float) -> Run:
    """Return how long steps took in ms, the map at some steps, and what a database would get."""
    options, sensor = MappingOptions(tolerance=tolerance), Sensor(72, 2.0, 20)
    times, states, written, before = [], {}, 0, MetricMap()
    begun = time.perf_counter()
    for number, taken in enumerate(explore(world(), sensor, wander(STEPS), options), start=1):
        times.append((time.perf_counter() - begun) * 1000)
        for zone in taken.state.metric.changed_since(before):
            written += sum(map(len, shape_bytes(zone)))
        before = taken.state.metric
        if number in MARKS:
            states[number] = taken.state
        begun = time.perf_counter()
    return times, states, written


def memory_mb(tolerance: float, steps: int) -> float:
    """Return the memory that the map needs at most, over an empty one, in MB (without GEOS)."""
    walk, options = wander(steps), MappingOptions(tolerance=tolerance)
    plan = world()
    tracemalloc.start()
    for _ in explore(plan, Sensor(72, 2.0, 20), walk, options):
        pass
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    return peak / 1e6


def grid_bytes(state: MapState) -> int:
    """Return the size of a PNG of the map: unknown, or free, in cells of 0.05 m."""
    free = shapely.union_all([zone.region for zone in state.metric.zones.values()])
    low_x, low_y, high_x, high_y = free.bounds
    x, y = np.arange(low_x, high_x, CELL), np.arange(low_y, high_y, CELL)
    shapely.prepare(free)
    inside = shapely.contains_xy(free, *np.meshgrid(x, y))
    file = io.BytesIO()
    Image.fromarray((inside * 255).astype(np.uint8)).convert("1").save(file, "PNG", optimize=True)
    return len(file.getvalue())


def vertices(state: MapState) -> int:
    """Return the vertices of the whole map."""
    return sum(count_vertices(zone.region) for zone in state.metric.zones.values())


def differing(one: MapState, other: MapState, tolerance: float) -> float:
    """Return the greatest symmetric difference of two zones, over tolerance times perimeter."""
    shares = [
        zone.region.symmetric_difference(it.region).area / (tolerance * it.region.length)
        for zone, it in zip(one.metric.zones.values(), other.metric.zones.values(), strict=True)
    ]
    return max(shares)


def tables() -> Iterator[Table]:
    """Yield the cost of steps early and late, and what the map holds then."""
    runs = {tolerance: run(tolerance) for tolerance in TOLERANCES}
    rows = []
    for tolerance, (times, states, written) in runs.items():
        early, late = float(np.mean(times[100:1_100])), float(np.mean(times[-1_000:]))
        row = {
            "tolerance, m": f"{tolerance}", "steps 101-1,100, ms": f"{early:.3f}",
            "last 1,000, ms": f"{late:.3f}", "ratio": f"{late / early:.2f}",
            "bytes written a step": f"{written / STEPS:.0f}",
            "MB at most in 1,000 steps": f"{memory_mb(tolerance, 1_000):.1f}",
        }  # fmt: skip
        for mark in MARKS:
            row[f"vertices at {mark}"] = str(vertices(states[mark]))
            share = differing(states[mark], runs[0.0][1][mark], tolerance) if tolerance else 0.0
            row[f"difference / (tolerance x perimeter) at {mark}"] = f"{share:.2f}"
        row["GeoJSON, bytes"] = str(len(zones_body(states[STEPS])))
        row[f"grid PNG of {CELL} m, bytes"] = str(grid_bytes(states[STEPS]))
        rows.append(row)
    yield f"Growth: {STEPS:,} steps at 72 beams", rows
