"""Lengths inside a zone: found in a window, and equal to those found in all of it."""

from __future__ import annotations

import itertools
import math
from random import Random

import pytest
import shapely
from shapely import MultiPolygon, Polygon, affinity, box

from semtopo.doorways import Doorway
from semtopo.freespace import FreeSpace
from semtopo.geometry import Region, polygonal
from semtopo.ground import Ground
from semtopo.types import Point
from tests.regions import DRAWS, Draw, far_away, place, stars

SAME = 1e-7
"""m; ways in a window keep the same distance of 1e-8 m from walls, but from each corner by itself:
what is cut somewhere else may round differently."""


def doorway(region: Region) -> Doorway:
    return Doorway(("a", "b"), 0, region, 1, 1)


def whole(ground: Ground, start: Point, end: Point) -> float:
    """Return the length as all of the ground gives it."""
    anew = Ground(ground.zone, ground.doorways)
    anew._spent = anew.size
    return anew.length(start, end)


def drawn(draw: Draw, random: Random) -> Ground:
    """Return a region with some of it cut out, which are the doorways, and the rest the zone."""
    region = draw(random)
    doors: list[Region] = []
    for _ in range(4):
        x, y = place(random, region)
        tile = affinity.rotate(box(x - 0.6, y - 0.4, x + 0.6, y + 0.4), random.uniform(0, 90))
        door = polygonal(region.intersection(tile))
        rest = polygonal(region.difference(tile))
        if door.area > 0 and rest.area > 0:
            doors, region = [*doors, door], rest
    return Ground(region, tuple(map(doorway, doors)))


@pytest.fixture
def tried(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """Collect the areas of what free space is made of."""
    found: list[float] = []

    def noted(region: Region) -> FreeSpace:
        found.append(region.area)
        return FreeSpace(region)

    monkeypatch.setattr("semtopo.ground.FreeSpace", noted)
    return found


@pytest.mark.parametrize("draw", [*DRAWS, far_away(stars)], ids=lambda draw: draw.__name__)
def test_a_window_gives_what_the_whole_gives(draw: Draw, tried: list[float]) -> None:
    bent = partly = 0
    for seed in range(6):
        random = Random(seed)
        ground = drawn(draw, random)
        area = float(shapely.area(ground.parts).sum())
        region = polygonal(shapely.union_all(ground.parts))
        for _ in range(8):
            start, end = place(random, region), place(random, region)
            if random.random() < 0.3:  # a passage point beside the ground, as seen from afar
                end = (end[0] + random.uniform(-0.5, 0.5), end[1] + random.uniform(-0.5, 0.5))
            tried.clear()
            ground._spent = 0
            length = ground.length(start, end)
            bent += length > math.dist(start, end)
            partly += bool(tried) and max(tried) < 0.9 * area
            assert length == pytest.approx(whole(ground, start, end), abs=SAME, rel=1e-12)
    assert bent >= 4
    assert partly >= 4


def comb(teeth: int) -> Polygon:
    """Return a hall of 1 m by `teeth`, with niches on one side and walls that reach into it."""
    walls = [box(x + 0.4, 0, x + 0.6, 0.3) for x in range(teeth)]
    niches = [box(x + 0.1, 1, x + 0.3, 1.5) for x in range(teeth)]
    hall = shapely.union_all([box(0, 0, teeth, 1), *niches])
    found = shapely.difference(hall, shapely.union_all(walls))
    assert isinstance(found, Polygon)
    return found


def test_a_short_way_in_a_long_hall_looks_at_little_of_it(tried: list[float]) -> None:
    ground = Ground(comb(200), ())
    length = ground.length((100.2, 0.1), (102.2, 0.1))
    assert 2 < length < 2.2
    assert sum(tried) < 0.05 * ground.zone.area
    assert length == pytest.approx(whole(ground, (100.2, 0.1), (102.2, 0.1)), abs=SAME)


def test_all_of_it_is_looked_at_once_when_windows_have_cost_as_much(tried: list[float]) -> None:
    ground = Ground(comb(40), ())
    places = [(x + 0.2, 0.1) for x in range(40)]
    lengths = [ground.length(*ends) for ends in itertools.permutations(places[::4], 2)]
    of_all = [area for area in tried if area > 0.9 * ground.zone.area]
    assert len(of_all) == 1
    assert tried[-1] == of_all[0]
    assert 2 < len(tried) < len(lengths) / 2
    assert ground._spent < 2 * ground.size


def test_where_nothing_leads_the_way_is_straight(tried: list[float]) -> None:
    apart = MultiPolygon([box(0, 0, 1, 1), box(3, 0, 4, 1)])
    ground = Ground(apart, ())
    assert ground.length((0.5, 0.5), (3.5, 0.5)) == 3
    assert max(tried) == pytest.approx(apart.area)


def test_a_far_detour_is_found() -> None:
    around = polygonal(box(0, 0, 100, 100).difference(box(49, -1, 51, 99)))
    ground = Ground(around, ())
    best = 2 * math.hypot(1, 98) + 2
    assert ground.length((48, 1), (52, 1)) == pytest.approx(best, abs=SAME)


def test_the_nearest_place_outside_the_first_window_counts() -> None:
    """Both ends are beside the ground, farther than the first window reaches."""
    ground = Ground(box(0, 2, 10, 3), ())
    for start, end in [((0, 0), (10, 0)), ((4, 0), (6, 0)), ((5, 0), (5, 0.01))]:
        around = 4 - start[1] - end[1] + abs(start[0] - end[0])
        assert ground.length(start, end) == pytest.approx(around, abs=SAME)
        assert whole(ground, start, end) == ground.length(start, end)


def test_lengths_are_kept(tried: list[float]) -> None:
    ground = Ground(comb(5), ())
    first = ground.length((0.2, 0.1), (3.2, 0.1))
    made = len(tried)
    assert made > 0
    assert ground.length((0.2, 0.1), (3.2, 0.1)) == first
    assert len(tried) == made
