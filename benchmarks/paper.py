"""The paper's scenario, and walks through its world."""

from __future__ import annotations

import math
from functools import cache
from pathlib import Path
from random import Random

import shapely
from shapely.geometry.base import BaseGeometry

from semtopo import Kind, World
from semtopo.formats import read_path, read_world
from semtopo.types import Point

EXAMPLE = Path(__file__).parents[1] / "examples" / "paper"


@cache
def world() -> World:
    """Return the corridor loop with four rooms."""
    return read_world((EXAMPLE / "world.json").read_bytes())


@cache
def path() -> list[Point]:
    """Return the 81 positions of the run."""
    return [pose.position for pose in read_path((EXAMPLE / "path.csv").read_bytes())]


def wander(steps: int, seed: int = 1) -> list[Point]:
    """Return positions of a robot that wanders through the paper's world, 0.2 m a step."""
    ground: BaseGeometry = shapely.Polygon()
    for zone in world().zones:
        box = shapely.box(*zone.low, *zone.high)
        ground = ground.difference(box) if zone.kind is Kind.OBSTACLE else ground.union(box)
    free = ground.buffer(-0.15)
    shapely.prepare(free)
    chance, heading, place = Random(seed), 0.0, path()[0]
    walk: list[Point] = []
    while len(walk) < steps:
        heading += chance.gauss(0, 0.5)
        ahead = (place[0] + 0.2 * math.cos(heading), place[1] + 0.2 * math.sin(heading))
        if free.covers(shapely.LineString([place, ahead])):
            place = ahead
            walk.append(place)
        else:
            heading += chance.uniform(1, 5)
    return walk
