"""Whether a step grows with the world, while what lies around the robot stays the same.

Each row of five square rooms with doors is out of sight of the others. The robot walks in the row
in the middle, so that it makes the same map in every world.
"""

from __future__ import annotations

import time
from collections.abc import Iterator

import numpy as np

from benchmarks.table import Table
from semtopo import Kind, MappingOptions, MapState, Sensor, World, WorldZone, scan_world, step
from semtopo.types import Point, Sensing

SIZES = (10, 100, 1_000, 10_000, 100_000)
ROOM, WALL = 3.0, 0.25
PITCH = ROOM + WALL
ACROSS = 5
ROW_PITCH = 6.0  # m, of which 3 m are solid: more than the range of the sensor, 2 m
STEPS = 200
ROUNDS = 3


def floor(zones: int) -> World:
    """Return a world of so many zones, a multiple of ten: five rooms and doors in each row."""
    made: list[WorldZone] = []
    for number in range(zones // 2):
        row, column = divmod(number, ACROSS)
        x, y = column * PITCH, row * ROW_PITCH
        room = WorldZone(f"room {number}", Kind.SPACE, (x, y), (x + ROOM, y + ROOM))
        door = (x + ROOM, y + 1), (x + PITCH, y + 2)
        made += [room, WorldZone("door", Kind.PASSAGE, *door)]
    return World(made)


def walk(world: World) -> list[Point]:
    """Return positions from room to room and back, in the row in the middle."""
    rows = len(world.zones) // (2 * ACROSS)
    x, y = world.zones[(rows // 2 * ACROSS + ACROSS // 2) * 2].low
    share = np.abs(np.linspace(-1, 1, STEPS))
    return [(float(x + 0.5 + s), float(y + 1.5 + 0.3 * s)) for s in share]


def timed(world: World, sensing: Sensing) -> tuple[float, float]:
    """Return what a step takes, and its measurement and analysis alone: means, in ms."""
    sensor, options = Sensor(72, 2.0, 20), MappingOptions(sensing=sensing)
    found = []
    for _ in range(ROUNDS):
        state, sensing_s, all_s = MapState(), 0.0, 0.0
        for position in walk(world):
            begun = time.perf_counter()
            scan = scan_world(world, sensor, position, sensing=sensing)
            sensing_s += time.perf_counter() - begun
            state = step(state, scan, options).state
            all_s += time.perf_counter() - begun
        found.append((all_s, sensing_s))
    total, sensed = min(found)
    return total * 1000 / STEPS, sensed * 1000 / STEPS


def tables() -> Iterator[Table]:
    """Yield what worlds of 10 to 100,000 zones cost, to make and to walk in."""
    rows, first = [], 0.0
    for zones in SIZES:
        begun = time.perf_counter()
        world = floor(zones)
        made = time.perf_counter() - begun
        total, sensed = timed(world, Sensing.SAMPLED)
        exact, _ = timed(world, Sensing.EXACT)
        first = first or total
        rows.append({
            "zones": f"{zones:,}", "made in, s": f"{made:.2f}",
            "step, ms": f"{total:.3f}", "of 10": f"{total / first:.2f}",
            "measurement and analysis, ms": f"{sensed:.3f}", "exact step, ms": f"{exact:.3f}",
        })  # fmt: skip
    yield "Worlds, at 72 beams", rows
