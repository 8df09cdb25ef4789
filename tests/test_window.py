"""A window says the same of every place as the whole world does."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from semtopo import window
from semtopo.types import Floats, Kind, Point
from semtopo.window import Offsets, Window
from semtopo.world import World, WorldZone
from tests.strategies import lattice_points, lattice_worlds, quick

HALVES = np.array(list(product(np.arange(-4, 5) / 2, repeat=2)))
"""Places around a point of a lattice: corners of rectangles, places on edges, and others."""


def check(world: World, centre: Point, around: Floats, reach: float) -> None:
    """Read places around a centre in a window, and one by one."""
    assert world.window(centre, reach) is not None
    surface = world.read_around(centre, Offsets.of(around[:, 0], around[:, 1], reach))
    label, kind = world.read(np.asarray(centre) + around)
    assert world.surfaces.label[surface].tolist() == label.tolist()
    assert world.surfaces.kind[surface].tolist() == kind.tolist()


@quick
@given(world=lattice_worlds(), centres=lattice_points)
def test_places_on_edges_and_corners_read_as_from_the_whole(
    world: World, centres: list[Point]
) -> None:
    for centre in centres:
        check(world, centre, HALVES, 3.0)


@quick
@given(world=lattice_worlds(), seed=st.integers(0, 2**32 - 1))
def test_any_place_reads_as_from_the_whole(world: World, seed: int) -> None:
    chance = np.random.default_rng(seed)
    centre = chance.uniform(-1, 8, 2)
    around = chance.uniform(-1, 1, (200, 2)) * chance.choice([1.0, 1e-3, 1e-9], (200, 1))
    check(world, (centre[0], centre[1]), around, 1.5)


@pytest.mark.parametrize("shift", [0.0, 1e3, 1e6, 1e9])
def test_far_from_the_origin_edges_are_exact_too(shift: float) -> None:
    world = World([WorldZone("a", Kind.SPACE, (shift, shift), (shift + 1, shift + 2))])
    steps = np.nextafter(shift, [-np.inf, np.inf]) - shift
    offsets = [*steps, 0, *(np.nextafter(shift + 1, [-np.inf, np.inf]) - shift), 1, 2]
    check(world, (shift, shift), np.array(list(product(offsets, repeat=2))), 3.0)


def test_too_many_edges_make_no_window_and_read_the_same() -> None:
    ends = np.linspace(0, 1, 200)
    zones = [WorldZone(f"r{n}", Kind.SPACE, (e, e), (e + 0.2, e + 0.3)) for n, e in enumerate(ends)]
    world = World(zones)
    assert world.window((0.5, 0.5), 1.0) is None
    around = np.random.default_rng(3).uniform(-1, 1, (500, 2))
    surface = world.read_around((0.5, 0.5), Offsets.of(around[:, 0], around[:, 1], 1.0))
    wanted, _ = world.read(np.array([0.5, 0.5]) + around)
    assert world.surfaces.label[surface].tolist() == wanted.tolist()
    assert len(set(wanted.tolist())) > 50


def test_too_many_rectangles_make_no_window() -> None:
    count = window.RECTANGLES_MAX + 1
    low, high = np.zeros((count, 2)), np.ones((count, 2))
    values, corner = np.zeros(count + 1, dtype=np.intp), (-1.0, -1.0)
    assert Window.laid(low, high, values, corner, 1.0) is None
    assert Window.laid(low[1:], high[1:], values[1:], corner, 1.0) is not None


def test_a_window_serves_all_centres_of_its_middle_third() -> None:
    world = World([WorldZone("a", Kind.SPACE, (0, 0), (9, 9))])
    one = world.window((2.0, 2.0), 2.0)
    assert world.window((3.9, 3.9), 2.0) is one
    assert world.window((4.0, 3.9), 2.0) is not one
    assert world.window((2.0, 2.0), 1.0) is not one


def test_only_so_many_windows_are_kept() -> None:
    world = World([WorldZone("a", Kind.SPACE, (0, 0), (9, 9))])
    first = world.window((0.5, 0.5), 1.0)
    kept = [world.window((x + 0.5, 0.5), 1.0) for x in range(64)]
    assert kept[0] is first
    assert world.window((63.5, 0.5), 1.0) is kept[63]
    world.window((64.5, 0.5), 1.0)
    assert world.window((0.5, 0.5), 1.0) is not first
