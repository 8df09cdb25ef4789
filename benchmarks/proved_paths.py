"""Random dense paths in regions that are hard, each checked by what shares no code with the search.

A path must lie in the region as it was given, no nearer to its border than the robot's radius, and
be as short as the full visibility graph of the ground for the robot's centre has it. Where a path
is refused there must be none. Regions are those of the tests, and squares with 50 holes or more;
ground of more than VERTICES_MAX vertices is passed over, as its visibility graph takes too long.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from itertools import count, islice
from random import Random

import shapely
from shapely import LineString

from benchmarks.dense_paths import field
from benchmarks.table import Row, Table
from semtopo.errors.ways import NotConnectedError, TooNarrowError
from semtopo.freespace import FreeSpace
from semtopo.geometry import Region
from semtopo.types import Point
from tests.regions import DRAWS, Draw, place
from tests.visibility import ShortestWays

QUERIES = 10_000
IN_A_SPACE = 20
"""Queries before the next space is drawn."""

RADII = (0.0, 0.02, 0.1, 0.3)
VERTICES_MAX = 800
HOLES = 50
WITHIN = 0.01
"""Of the optimum; a path that is longer by more is counted."""

ROUNDING = 1e-7
"""m; by which lengths may differ, added up in another order."""


def fifty_holes(random: Random) -> Region:
    """Return a square with 50 stars cut out that touch nothing."""
    return field(500, random.randrange(10**6)).region


def spaces(draw: Draw) -> Iterator[FreeSpace]:
    """Yield spaces for robots of all radii, without end."""
    for seed in count():
        region = draw(Random(seed))
        for radius in RADII:
            space = FreeSpace(region, radius)
            if 0 < shapely.get_num_coordinates(space.inset) <= VERTICES_MAX:
                yield space


def judged(space: FreeSpace, ways: ShortestWays, random: Random) -> Iterator[str]:
    """Yield all that is to be said of one query."""
    yield "queries"
    holes = shapely.get_num_interior_rings(shapely.get_parts(space.region))
    if max(holes) >= HOLES:
        yield f"with {HOLES} holes"
    start, goal = ends(space, random)
    best = ways.length(start, goal)
    try:
        path = space.path(start, goal)
    except (NotConnectedError, TooNarrowError) as refused:
        yield "not connected" if isinstance(refused, NotConnectedError) else "too narrow"
        if best is not None:
            yield "wrongly refused"
        return
    yield from ("paths", "with bends") if len(path.points) > len((start, goal)) else ("paths",)
    line = LineString(path.points)
    clear = line.distance(shapely.boundary(space.region)) >= space.radius
    if not (clear and space.region.covers(line)):
        yield "outside free space"
    yield from compared(line.length, best)


def compared(length: float, best: float | None) -> Iterator[str]:
    """Yield what is to be said of a path's length in m, and of the optimum, if there is a way."""
    if best is None or length < best - ROUNDING:
        yield "shorter than can be"
    elif length > best + ROUNDING:
        yield "longer at all"
        if length > best * (1 + WITHIN):
            yield "over 1 % longer"


FAULTS = (
    "outside free space", "longer at all", "over 1 % longer", "shorter than can be",
    "wrongly refused",
)  # fmt: skip
COUNTED = (
    "queries",
    f"with {HOLES} holes",
    "paths",
    "with bends",
    "not connected",
    "too narrow",
    *FAULTS,
)


def ends(space: FreeSpace, random: Random) -> tuple[Point, Point]:
    """Return two places where the robot may be, near to hard places of the region."""
    one, other = (space.nearest_place(place(random, space.region)) for _ in range(2))
    return one or (0.0, 0.0), other or (0.0, 0.0)  # a space that is not empty has them


def row(draw: Draw, queries: int) -> Row:
    """Ask so many queries, and return what came of them."""
    counts: Counter[str] = Counter()
    for number, space in enumerate(islice(spaces(draw), -(-queries // IN_A_SPACE))):
        ways, random = ShortestWays(space.inset), Random(number)
        for _ in range(IN_A_SPACE):
            counts.update(judged(space, ways, random))
    return {"regions": draw.__name__, **{name: f"{counts[name]:,}" for name in COUNTED}}


def tables() -> Iterator[Table]:
    """Yield what came of all queries, by kind of region."""
    draws = (*DRAWS, fifty_holes)
    rows = [row(draw, -(-QUERIES // len(draws))) for draw in draws]
    total = {name: f"{sum(int(it[name].replace(',', '')) for it in rows):,}" for name in COUNTED}
    radii = ", ".join(map(str, RADII))
    yield f"Random paths, radius {radii} m", [*rows, {"regions": "all", **total}]
