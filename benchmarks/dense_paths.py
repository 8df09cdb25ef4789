"""Time dense paths beside two peers.

The peers are no dependency (`make peers`); without them only our own times are given. In each round
a map has changed: everything is built anew, and one query is answered. Lengths are compared: who is
fast and wrong does not count.
"""

from __future__ import annotations

import math
import statistics
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from random import Random
from typing import TypeAlias

from shapely import LineString, Polygon

from benchmarks.peers import NOT_THERE, is_there
from benchmarks.table import Table
from semtopo.freespace import FreeSpace
from semtopo.geometry import Region
from semtopo.types import Point

COMPARED = (100, 500)
GROWING = (100, 500, 2000)
"""Vertices of regions: beside peers, and alone."""

SIZE = 10.0
"""m; the side of the square that all is in."""

START, GOAL = (0.05, 0.05), (SIZE - 0.05, SIZE - 0.05)

Ring: TypeAlias = list[Point]


@dataclass(frozen=True, slots=True)
class Field:
    """A square with star-shaped holes that do not touch."""

    square: Ring
    holes: list[Ring]

    @property
    def vertices(self) -> int:
        """How many vertices it has."""
        return len(self.square) + sum(map(len, self.holes))

    @property
    def region(self) -> Region:
        """The same as a polygon; a new one each time, as after a change."""
        return Polygon(self.square, self.holes)


def field(vertices: int, seed: int = 0) -> Field:
    """Return a field of about so many vertices, in holes of ten."""
    random, count = Random(seed), vertices // 10
    columns = math.ceil(math.sqrt(count))
    cell = SIZE / columns
    holes = []
    for number in range(count):
        x, y = (number % columns + 0.5) * cell, (number // columns + 0.5) * cell
        turn = random.random()
        radii = [cell * (0.45 if tip % 2 else 0.2) for tip in range(10)]
        angles = [2 * math.pi * (tip + turn) / 10 for tip in range(10)]
        holes.append([
            (x + radius * math.cos(angle), y + radius * math.sin(angle))
            for radius, angle in zip(radii, angles, strict=True)
        ])  # fmt: skip
    return Field([(0, 0), (SIZE, 0), (SIZE, SIZE), (0, SIZE)], holes)


def ours(world: Field, radius: float = 0.0) -> float:
    """Build and ask once; return the length."""
    return FreeSpace(world.region, radius).distance(START, GOAL)


def extremitypathfinder(world: Field) -> float:
    """Build and ask extremitypathfinder once; return the length."""
    from extremitypathfinder import PolygonEnvironment  # noqa: PLC0415 -- may not be installed

    environment = PolygonEnvironment()
    environment.store(world.square, [hole[::-1] for hole in world.holes])
    return float(environment.find_shortest_path(START, GOAL)[1])


def pyvisgraph(world: Field) -> float:
    """Build and ask pyvisgraph once; return the length."""
    from pyvisgraph import Point as Vertex  # noqa: PLC0415 -- may not be installed
    from pyvisgraph import VisGraph  # noqa: PLC0415

    graph = VisGraph()
    graph.build([[Vertex(x, y) for x, y in hole] for hole in world.holes], workers=1, status=False)
    path = graph.shortest_path(Vertex(*START), Vertex(*GOAL))
    return LineString([(one.x, one.y) for one in path]).length


PEERS: dict[str, Callable[[Field], float]] = {
    "extremitypathfinder": extremitypathfinder,
    "pyvisgraph": pyvisgraph,
}


def timed(work: Callable[[Field], float], world: Field, rounds: int) -> tuple[float, float]:
    """Return the median CPU time of some rounds in ms, and the length found; none uses threads."""
    times, length = [], 0.0
    for _ in range(rounds):
        begun = time.process_time()
        length = work(world)
        times.append(1000 * (time.process_time() - begun))
    return statistics.median(times), length


def peers_table(vertices: int) -> Table:
    """Compare one query after a change with each peer that is there."""
    world = field(vertices)
    own, length = timed(ours, world, 15)
    rows = [{"who": "semtopo", "ms": f"{own:.1f}", "times ours": "1", "length m": f"{length:.6f}"}]
    for name, work in PEERS.items():
        if not is_there(name):
            rows.append({"who": name, "ms": NOT_THERE, "times ours": "", "length m": ""})
            continue
        took, found = timed(work, world, 3)
        rows.append({
            "who": name, "ms": f"{took:.1f}", "times ours": f"{took / own:.0f}",
            "length m": f"{found:.6f}",
        })  # fmt: skip
    return (f"path after a change, {world.vertices} vertices, radius 0", rows)


def _again(space: FreeSpace, _world: Field) -> float:
    return space.distance(START, GOAL)


def growth_table() -> Table:
    """Time the first query after a change, and a later one, as regions grow."""
    rows = []
    for vertices, radius in [(n, r) for n in GROWING for r in (0.0, 0.02)]:
        world = field(vertices)
        first, _ = timed(partial(ours, radius=radius), world, 1)
        space = FreeSpace(world.region, radius)
        space.distance(START, GOAL)
        later, _ = timed(partial(_again, space), world, 3)
        rows.append({
            "vertices": str(world.vertices), "radius m": f"{radius:g}",
            "after a change ms": f"{first:.1f}", "later ms": f"{later:.1f}",
        })  # fmt: skip
    return ("time as regions grow, corner to corner", rows)


def tables() -> Iterator[Table]:
    """Yield each table as soon as it is there."""
    for vertices in COMPARED:
        yield peers_table(vertices)
    yield growth_table()
