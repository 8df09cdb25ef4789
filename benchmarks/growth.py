"""Whether a step grows with time: 10,000 steps of wandering in the paper's world."""

from __future__ import annotations

import time
from collections.abc import Iterator

import numpy as np

from benchmarks.paper import wander, world
from benchmarks.table import Table
from semtopo import MappingOptions, MapState, Sensor, explore
from semtopo.geometry import count_vertices

STEPS = 10_000
MARKS = (1_000, 10_000)
TOLERANCES = (0.0, 0.02, 0.05)

Run = tuple[list[float], dict[int, MapState]]


def run(tolerance: float) -> Run:
    """Return how long steps took in ms, and the map at some steps."""
    options, sensor = MappingOptions(tolerance=tolerance), Sensor(72, 2.0, 20)
    times, states = [], {}
    begun = time.perf_counter()
    for number, taken in enumerate(explore(world(), sensor, wander(STEPS), options), start=1):
        times.append((time.perf_counter() - begun) * 1000)
        if number in MARKS:
            states[number] = taken.state
        begun = time.perf_counter()
    return times, states


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
    for tolerance, (times, states) in runs.items():
        early, late = float(np.mean(times[100:1_100])), float(np.mean(times[-1_000:]))
        row = {
            "tolerance, m": f"{tolerance}", "steps 101-1,100, ms": f"{early:.3f}",
            "last 1,000, ms": f"{late:.3f}", "ratio": f"{late / early:.2f}",
        }  # fmt: skip
        for mark in MARKS:
            row[f"vertices at {mark}"] = str(vertices(states[mark]))
            share = differing(states[mark], runs[0.0][1][mark], tolerance) if tolerance else 0.0
            row[f"difference / (tolerance x perimeter) at {mark}"] = f"{share:.2f}"
        rows.append(row)
    yield f"Growth: {STEPS:,} steps at 72 beams", rows
