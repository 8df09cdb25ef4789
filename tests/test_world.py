"""What the world says is where: the fast reading against the naive one."""

from __future__ import annotations

import math
from collections.abc import Iterator
from time import process_time

import numpy as np
import pytest
from hypothesis import given

from semtopo.errors import InvalidWorldError
from semtopo.types import NOWHERE, Kind, Point
from semtopo.world import World, WorldZone
from tests import oracle
from tests.strategies import lattice_points, lattice_worlds, quick


def read(world: World, *points: Point) -> list[tuple[str, Kind]]:
    """Read some points, with their labels as words; nowhere is the empty word."""
    labels, kinds = world.read(np.array(points, dtype=np.float64))
    names = [world.labels[number] if number != NOWHERE else "" for number in labels.tolist()]
    return [(name, Kind(kind)) for name, kind in zip(names, kinds.tolist(), strict=True)]


def box(label: str, low: Point, high: Point, kind: Kind = Kind.SPACE) -> WorldZone:
    return WorldZone(label, kind, low, high)


@quick
@given(world=lattice_worlds(), points=lattice_points)
def test_read_equals_the_naive_oracle(world: World, points: list[Point]) -> None:
    wanted = [oracle.read_map(world, point) for point in points]
    assert read(world, *points) == [(sample.label, sample.kind) for sample in wanted]


@quick
@given(world=lattice_worlds(), points=lattice_points)
def test_one_point_is_read_as_among_others(world: World, points: list[Point]) -> None:
    assert [read(world, point)[0] for point in points] == read(world, *points)


def crowds(count: int) -> Iterator[list[WorldZone]]:
    """Yield zones that lie on one another in many ways, all around (5, 5)."""
    chance = np.random.default_rng(7)
    low = chance.uniform(2, 8, (count, 2))
    high = low + chance.uniform(0.05, 1, (count, 2)) ** 3
    yield [box(f"r{n}", tuple(low[n]), tuple(high[n])) for n in range(count)]  # at random
    share = np.linspace(0, 1, count)
    yield [box(f"n{n}", (3 + s, 3 + s), (7.5 - s, 7.5 - s)) for n, s in enumerate(share)]  # nested
    yield [box(f"o{n}", (3 + s, 3 + s), (7.5 - s, 7.5 - s)) for n, s in enumerate(share[::-1])]
    yield [box(f"s{n}", (0, 3 + 4 * s), (9, 3.003 + 4 * s)) for n, s in enumerate(share)]  # strips
    yield [box(f"e{n}", (0, 0), (9, 9)) for n in range(count)]  # all the same


@pytest.mark.parametrize("number", range(5))
@pytest.mark.parametrize("points", [1, 2, 50, 3_000])
def test_a_crowd_of_zones_is_read_as_the_few_are(number: int, points: int) -> None:
    zones = list(crowds(700))[number]
    world = World(zones)
    xy = np.concatenate([
        np.random.default_rng(points).normal(5, 1.5, (points, 2)),
        [zones[300].low, zones[300].high, zones[699].low, (5.0, 5.0), (5.0, 5.0)],
    ])  # fmt: skip
    top = np.full(len(xy), NOWHERE)
    for index, zone in enumerate(zones):
        top[((xy >= zone.low) & (xy <= zone.high)).all(axis=1)] = index
    assert world.read(xy)[0].tolist() == top.tolist()


def test_thousands_of_zones_on_one_another_take_no_long_time() -> None:
    """Each of 20,000 points was once compared with each of 10,000 zones."""
    xy = np.random.default_rng(1).normal(5, 1.5, (20_000, 2))
    for zones in crowds(10_000):
        world = World(zones)
        began = process_time()
        world.read(xy)
        assert process_time() - began < 2.0


def test_outside_all_zones_is_obstacle() -> None:
    world = World([box("a", (0, 0), (1, 1))])
    outside = [(-0.001, 0.5), (0.5, 1.001), (1e9, 1e9)]
    assert read(world, *outside) == [("", Kind.OBSTACLE)] * 3


@pytest.mark.parametrize("corner", [(0, 0), (0, 1), (2, 1), (2, 0), (1, 0), (0, 0.5)])
def test_edges_and_corners_belong_to_the_zone(corner: Point) -> None:
    assert read(World([box("a", (0, 0), (2, 1))]), corner) == [("a", Kind.SPACE)]


def test_the_later_zone_is_on_top() -> None:
    below, above = box("a", (0, 0), (2, 2)), box("b", (1, 1), (3, 3), Kind.PASSAGE)
    assert read(World([below, above]), (1.5, 1.5)) == [("b", Kind.PASSAGE)]
    assert read(World([above, below]), (1.5, 1.5)) == [("a", Kind.SPACE)]


def test_the_later_zone_has_the_common_edge() -> None:
    left, right = box("a", (0, 0), (1, 1)), box("b", (1, 0), (2, 1))
    assert read(World([left, right]), (1, 0.5)) == [("b", Kind.SPACE)]
    assert read(World([right, left]), (1, 0.5)) == [("a", Kind.SPACE)]


def test_a_label_stands_once_and_may_have_two_kinds() -> None:
    world = World([
        box("a", (0, 0), (1, 1)), box("b", (1, 0), (2, 1)), box("a", (3, 0), (4, 1), Kind.PASSAGE),
    ])  # fmt: skip
    assert world.labels == ("a", "b")
    assert read(world, (0.5, 0.5), (3.5, 0.5)) == [("a", Kind.SPACE), ("a", Kind.PASSAGE)]


@pytest.mark.parametrize("shape", [(2,), (0, 2), (3, 2), (4, 5, 2)])
def test_answers_have_the_shape_of_the_points(shape: tuple[int, ...]) -> None:
    labels, kinds = World([box("a", (0, 0), (1, 1))]).read(np.full(shape, 0.5))
    assert labels.shape == kinds.shape == shape[:-1]
    assert kinds.dtype == np.uint8
    assert (labels == 0).all()
    assert (kinds == Kind.SPACE).all()


def test_a_world_keeps_name_and_zones() -> None:
    zone = box("a", (0, 0), (1, 1))
    world = World([zone], name="cell")
    assert (world.name, world.zones) == ("cell", (zone,))


def test_a_world_needs_a_zone() -> None:
    with pytest.raises(InvalidWorldError, match="at least one"):
        World([])


@pytest.mark.parametrize(
    ("label", "low", "high"),
    [
        ("", (0, 0), (1, 1)),
        ("a", (0, 0), (0, 1)),
        ("a", (0, 0), (1, 0)),
        ("a", (1, 0), (0, 1)),
        ("a", (0, 1), (1, 0)),
        ("a", (math.nan, 0), (1, 1)),
        ("a", (0, 0), (1, math.nan)),
        ("a", (0, -math.inf), (1, 1)),
        ("a", (0, 0), (math.inf, 1)),
    ],
)
def test_a_zone_needs_a_label_and_an_extent(label: str, low: Point, high: Point) -> None:
    with pytest.raises(InvalidWorldError):
        WorldZone(label, Kind.SPACE, low, high)
