"""The second door: labelled runs along the beams of a real robot."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given

from semtopo.errors import InvalidScanError
from semtopo.mapper import scan_world
from semtopo.runs import LabelledRuns, from_runs
from semtopo.sensor import Sensor
from semtopo.sensor_map import extract
from semtopo.types import Kind, MappingOptions, Occupancy, Point, Pose
from tests import oracle
from tests.oracle import Interval
from tests.plans import TWO_ROOMS, drawn
from tests.strategies import KINDS, labelled_runs, poses, quick
from tests.test_scan import spelled

Beam = list[tuple[str, float]]
NONE, FREE, PASSAGE, OBSTACLE = Occupancy


def runs(*beams: Beam, increment: float = 0.1) -> LabelledRuns:
    return LabelledRuns(
        angle_min=0.0, angle_increment=increment, range_max=4.0, beams=beams, kinds=KINDS
    )


def intervals(beam: Beam) -> list[Interval]:
    """Return the intervals of a single beam."""
    return spelled(from_runs(Pose(0, 0), runs(beam)))[0]


@pytest.mark.parametrize(
    ("beam", "wanted"),
    [
        ([], []),
        ([("a", 4.0)], [Interval("a", 0, 4, NONE, FREE, "", from_robot=True)]),
        ([("a", 3.0)], [Interval("a", 0, 3, NONE, OBSTACLE, "", from_robot=True)]),
        ([("a", 1.0), ("a", 4.0)], [Interval("a", 0, 4, NONE, FREE, "", from_robot=True)]),
        ([("door", 4.0)], []),
        ([("wall", 1.0), ("a", 4.0)], []),
        ([("a", 1.0), ("wall", 2.0), ("b", 4.0)],
         [Interval("a", 0, 1, NONE, OBSTACLE, "", from_robot=True)]),
        ([("a", 1.0), ("fog", 4.0)], [Interval("a", 0, 1, NONE, FREE, "", from_robot=True)]),
        ([("a", 1.0), ("door", 2.0), ("b", 3.0)],
         [Interval("a", 0, 1, NONE, PASSAGE, "", from_robot=True),
          Interval("b", 2, 3, PASSAGE, OBSTACLE, "a", from_robot=False)]),
        ([("a", 1.0), ("b", 4.0)],
         [Interval("a", 0, 1, NONE, PASSAGE, "", from_robot=True),
          Interval("b", 1, 4, PASSAGE, FREE, "a", from_robot=False)]),
        ([("a", 1.0), ("fog", 2.0), ("door", 3.0), ("b", 4.0)],
         [Interval("a", 0, 1, NONE, FREE, "", from_robot=True),
          Interval("b", 3, 4, PASSAGE, FREE, "", from_robot=False)]),
        ([("a", 1.0), ("door", 2.0), ("a", 3.0), ("door", 3.5), ("b", 4.0)],
         [Interval("a", 0, 1, NONE, PASSAGE, "", from_robot=True),
          Interval("a", 2, 3, PASSAGE, PASSAGE, "a", from_robot=False),
          Interval("b", 3.5, 4, PASSAGE, FREE, "a", from_robot=False)]),
    ],
)  # fmt: skip
def test_one_beam(beam: Beam, wanted: list[Interval]) -> None:
    assert intervals(beam) == wanted


@quick
@given(seen=labelled_runs(), pose=poses)
def test_intervals_equal_the_oracles(seen: LabelledRuns, pose: Pose) -> None:
    scan, wanted = from_runs(pose, seen), oracle.analyse_runs(pose, seen)
    assert spelled(scan) == wanted.beams
    assert scan.fan.ring == wanted.ring
    np.testing.assert_allclose(scan.fan.directions, wanted.directions, atol=1e-12)


@pytest.mark.parametrize(
    ("increment", "wanted"),
    [(math.pi / 2, (0, 1)), (-math.pi / 2, (0, -1)), (math.pi, (-1, 0))],
)
def test_beams_turn_counter_clockwise_from_x(increment: float, wanted: Point) -> None:
    seen = runs([("a", 1.0)], [("a", 1.0)], increment=increment)
    np.testing.assert_allclose(seen.directions(0.0), [(1, 0), wanted], atol=1e-15)


def test_beams_turn_with_the_robot() -> None:
    seen = replace(runs([("a", 1.0)]), angle_min=math.pi / 2)
    np.testing.assert_allclose(seen.directions(math.pi / 2), [(-1, 0)], atol=1e-15)


@pytest.mark.parametrize(
    ("beams", "degrees", "ring"),
    [
        (360, 1.0, True),
        (360, -1.0, True),
        (180, 1.0, False),
        (359, 1.0, False),
        (361, 1.0, False),
        (360, 0.99995, True),
        (360, 1.0005, True),
        (361, 0.999, False),
        (4, 90.0, True),
        (3, 90.0, False),
    ],
)
def test_ring(beams: int, degrees: float, ring: bool) -> None:  # noqa: FBT001 -- a wanted value
    seen = runs(*[[("a", 1.0)]] * beams, increment=math.radians(degrees))
    assert seen.ring is ring


def test_both_doors_lead_to_the_same_zones() -> None:
    """The samples of a simulated sensor, told as runs, make zones half a sample larger at most."""
    world, sensor, position = drawn(TWO_ROOMS), Sensor(72, 4.0, 400), (1.97, 2.53)
    rows = oracle.measure(world, sensor, position)
    seen = LabelledRuns(
        angle_min=math.pi / 2,
        angle_increment=-2 * math.pi / 72,
        range_max=4.0,
        beams=[
            [(s.label or "#", float(r)) for s, r in zip(row, sensor.radii, strict=True)]
            for row in rows
        ],
        kinds={"+": Kind.PASSAGE, "#": Kind.OBSTACLE},
    )
    told = extract(from_runs(Pose(*position), seen), MappingOptions())
    sampled = extract(scan_world(world, sensor, position), MappingOptions())
    assert [zone.label for zone in told.zones] == [zone.label for zone in sampled.zones]
    for one, two in zip(told.zones, sampled.zones, strict=True):
        assert one.region.symmetric_difference(two.region).area < 0.02 * two.region.area


def test_a_scan_without_beams_shows_nothing() -> None:
    assert extract(from_runs(Pose(0, 0), runs()), MappingOptions()).zones == ()


@pytest.mark.parametrize(
    "beam",
    [
        [("a", 0.0)],
        [("a", -1.0)],
        [("a", 4.001)],
        [("a", math.nan)],
        [("a", math.inf)],
        [("a", 1.0), ("b", 1.0)],
        [("a", 2.0), ("b", 1.0)],
    ],
)
def test_radii_must_ascend_within_the_range(beam: Beam) -> None:
    with pytest.raises(InvalidScanError, match="beam 1"):
        runs([("a", 1.0)], beam)


@pytest.mark.parametrize("name", ["angle_min", "angle_increment", "range_max"])
@pytest.mark.parametrize("number", [math.nan, math.inf])
def test_numbers_must_be_finite(name: str, number: float) -> None:
    with pytest.raises(InvalidScanError, match="finite"):
        LabelledRuns(
            **{"angle_min": 0.0, "angle_increment": 1.0, "range_max": 4.0, name: number},
            beams=[[("a", 1.0)]],
            kinds={},
        )


@pytest.mark.parametrize("range_max", [0.0, -1.0])
def test_range_must_be_positive(range_max: float) -> None:
    with pytest.raises(InvalidScanError, match="range_max"):
        replace(runs(), range_max=range_max)


def test_beams_must_advance() -> None:
    with pytest.raises(InvalidScanError, match="angle_increment"):
        runs([("a", 1.0)], [("a", 1.0)], increment=0.0)


def test_beams_must_not_go_round_twice() -> None:
    with pytest.raises(InvalidScanError, match="more than once"):
        runs(*[[("a", 1.0)]] * 362, increment=math.radians(1))


def test_a_run_needs_a_label() -> None:
    """A zone of a world needs one; the empty word stands for "no source" inside `from_runs`."""
    with pytest.raises(InvalidScanError, match="label"):
        runs([("", 1.0)])
