"""Regions that are hard for path planners, drawn from a seed."""

from __future__ import annotations

import math
from collections.abc import Callable
from random import Random
from typing import TypeAlias

import shapely
from shapely import LineString, Polygon, affinity, box

from semtopo.geometry import Region, polygonal
from semtopo.types import Point

Draw: TypeAlias = Callable[[Random], Region]

SIDE = 10.0
"""m; regions lie about in a square of this size."""


def star(random: Random, centre: Point, size: float) -> Region:
    """Return a star with 2 to 6 tips of random length: every second vertex is a corner."""
    angles = sorted(random.uniform(0, 2 * math.pi) for _ in range(2 * random.randint(2, 6)))
    radii = [size * random.uniform(0.2, 0.4 if place % 2 else 1.0) for place in range(len(angles))]
    rim = [
        (centre[0] + radius * math.cos(angle), centre[1] + radius * math.sin(angle))
        for angle, radius in zip(angles, radii, strict=True)
    ]
    return polygonal(Polygon(rim).buffer(0))


def stars(random: Random) -> Region:
    """Return a square with up to 50 stars cut out; they may overlap and reach over its border."""
    count = random.randint(1, 50)
    size = 4 / math.sqrt(count)
    holes = [star(random, _anywhere(random), size) for _ in range(count)]
    return polygonal(box(0, 0, SIDE, SIDE).difference(shapely.union_all(holes)))


def grid(random: Random) -> Region:
    """Return a grid of cells, some walled: all sides are collinear, holes touch in points."""
    cells = random.randint(3, 9)
    walled = [
        box(x, y, x + 1, y + 1)
        for x in range(cells) for y in range(cells) if random.random() < random.choice([0.2, 0.35])
    ]  # fmt: skip
    return polygonal(box(0, 0, cells, cells).difference(shapely.union_all(walled)))


def turned_grid(random: Random) -> Region:
    """Return a grid that is turned, so that what is collinear is so but for rounding."""
    return affinity.rotate(grid(random), random.uniform(0, 90), origin=(3, -7))


def tiles(random: Random) -> Region:
    """Return many small rectangles on a lattice of 1/4 m, united as they fall: a MultiPolygon."""

    def tile() -> Polygon:
        x, y = random.randint(0, 36) / 4, random.randint(0, 36) / 4
        return box(x, y, x + random.randint(4, 24) / 4, y + random.randint(1, 6) / 4)

    return polygonal(shapely.union_all([tile() for _ in range(random.randint(15, 40))]))


def spikes(random: Random) -> Region:
    """Return a square crossed by needles, 1 mm at their feet and sharp."""
    needles = []
    for _ in range(random.randint(5, 40)):
        (x, y), angle = _anywhere(random), random.uniform(0, 7)
        length = random.uniform(0.5, 4)
        foot = (-0.001 * math.sin(angle), 0.001 * math.cos(angle))
        tip = (x + length * math.cos(angle), y + length * math.sin(angle))
        needles.append(Polygon([(x, y), (x + foot[0], y + foot[1]), tip]))
    return polygonal(box(0, 0, SIDE, SIDE).difference(shapely.union_all(needles)))


def gaps(random: Random) -> Region:
    """Return rows of walls with gaps between 1 um and 1 m."""
    walls = []
    for row in range(1, random.randint(3, 10)):
        x = 0.0
        while x < SIDE:
            end = x + random.uniform(0.5, 5)
            walls.append(box(x, row, min(end, SIDE), row + random.choice([0.01, 0.3])))
            x = end + 10 ** random.uniform(-6, 0)
    return polygonal(box(0, 0, SIDE, SIDE).difference(shapely.union_all(walls)))


def touching(random: Random) -> Region:
    """Return a square with diamonds that touch each other and the border in single points."""
    diamonds = [
        Polygon([(x - 1, y), (x, y - 1), (x + 1, y), (x, y + 1)])
        for x in range(1, 10, 2) for y in range(1, 10, 2) if random.random() < 0.4
    ]  # fmt: skip
    region: Region = box(0, 0, SIDE, SIDE)
    for diamond in diamonds:
        region = polygonal(region.difference(diamond))
    return region


def spiral(random: Random) -> Region:
    """Return one bent corridor that may cross itself, its joints round or sharp."""
    bends = [0.9 * number for number in range(1, random.randint(8, 40))]
    line = [(5 + 0.11 * bend * math.cos(bend), 5 + 0.11 * bend * math.sin(bend)) for bend in bends]
    width = random.uniform(0.01, 0.3)
    sharp = random.random() < 0.5
    corridor = LineString(line).buffer(width, join_style="mitre" if sharp else "round")
    return polygonal(corridor)


DRAWS: tuple[Draw, ...] = (stars, grid, turned_grid, tiles, spikes, gaps, touching, spiral)


def place(random: Random, region: Region) -> Point:
    """Return a vertex, a place on a side or a place in the region, each as often."""
    kind = random.randrange(3)
    if kind == 0:
        x, y = random.choice(shapely.get_coordinates(region).tolist())
        return (x, y)
    if kind == 1:
        point = shapely.line_interpolate_point(region.boundary, random.random(), normalized=True)
        return (point.x, point.y)
    low_x, low_y, high_x, high_y = region.bounds
    while True:
        x, y = random.uniform(low_x, high_x), random.uniform(low_y, high_y)
        if region.intersects(shapely.Point(x, y)):
            return (x, y)


def far_away(draw: Draw) -> Draw:
    """Return regions as of `draw`, but where coordinates have the fewest digits to spare."""

    def drawn(random: Random) -> Region:
        region = affinity.translate(draw(random), 9.2e5, -9.7e5)
        return polygonal(shapely.make_valid(region))

    drawn.__name__ = f"far_{draw.__name__}"
    return drawn


def _anywhere(random: Random) -> Point:
    """Return a place in the square."""
    return (random.uniform(0, SIDE), random.uniform(0, SIDE))
