"""The sensor: where its samples lie and what they meet."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given

from semtopo.errors import InvalidSensorError
from semtopo.sensor import Measurement, Sensor, measure
from semtopo.types import NOWHERE, Kind, Point
from tests import oracle
from tests.plans import TWO_ROOMS, drawn
from tests.strategies import Scene, offsets, quick, scenes


def words(seen: Measurement) -> list[list[oracle.Sample]]:
    """Return what each sample met, as the oracle says it."""
    names = {NOWHERE: "", **dict(enumerate(seen.labels))}
    return [
        [oracle.Sample(Kind(kind), names[label]) for kind, label in zip(*row, strict=True)]
        for row in zip(seen.kind.tolist(), seen.label.tolist(), strict=True)
    ]


def test_four_beams_look_north_east_south_west() -> None:
    wanted = [[0, 1], [1, 0], [0, -1], [-1, 0]]
    np.testing.assert_allclose(Sensor(beams=4).fan.directions, wanted, atol=1e-15)


def test_samples_are_evenly_spaced_up_to_the_range() -> None:
    radii = Sensor(beams=1, range=2.0, samples=20).radii
    np.testing.assert_allclose(radii, [0.1 * j for j in range(1, 21)], rtol=1e-15)
    assert radii[-1] == 2.0


def test_samples_lie_on_their_beams() -> None:
    seen = measure(drawn(TWO_ROOMS), Sensor(beams=4, range=1.0, samples=2), (1.5, 1.5))
    assert seen.xy.shape == (4, 2, 2)
    np.testing.assert_allclose(seen.xy[1], [[2.0, 1.5], [2.5, 1.5]], atol=1e-12)
    np.testing.assert_allclose(seen.xy[2], [[1.5, 1.0], [1.5, 0.5]], atol=1e-12)


def test_measure_reads_one_beam_through_a_door_into_the_wall() -> None:
    seen = measure(drawn(TWO_ROOMS), Sensor(beams=4, range=5.0, samples=5), (1.75, 2.5))
    east = [sample.label for sample in words(seen)[1]]
    assert east == ["a", "+", "b", "b", "#"]


@quick
@given(scene=scenes())
def test_measure_equals_the_oracle(scene: Scene) -> None:
    for position in scene.walk:
        seen = measure(scene.world, scene.sensor, position)
        assert words(seen) == oracle.measure(scene.world, scene.sensor, position)


@quick
@given(scene=scenes(), offset=offsets)
def test_moving_world_and_robot_moves_the_samples(scene: Scene, offset: Point) -> None:
    moved = scene.moved(*offset)
    for position, other in zip(scene.walk, moved.walk, strict=True):
        here = measure(scene.world, scene.sensor, position)
        there = measure(moved.world, scene.sensor, other)
        np.testing.assert_allclose(there.xy, here.xy + offset, atol=1e-9)
        assert words(there) == words(here)


def test_equal_sensors_are_equal() -> None:
    assert Sensor(beams=8) == Sensor(beams=8)
    assert Sensor(beams=8) != Sensor(beams=9)


@pytest.mark.parametrize("beams", [0, -1])
def test_a_sensor_needs_a_beam(beams: int) -> None:
    with pytest.raises(InvalidSensorError, match="beam"):
        Sensor(beams=beams)


@pytest.mark.parametrize("samples", [1, 0, -5])
def test_a_sensor_needs_two_samples(samples: int) -> None:
    with pytest.raises(InvalidSensorError, match="2 samples"):
        Sensor(samples=samples)


@pytest.mark.parametrize("range_", [0.0, -1.0, math.nan, math.inf])
def test_a_sensor_needs_a_range(range_: float) -> None:
    with pytest.raises(InvalidSensorError, match="range"):
        Sensor(range=range_)
