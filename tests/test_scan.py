"""The beam rule, on every sequence of seven samples; and the intervals that follow from it."""

from __future__ import annotations

from itertools import pairwise, product

import numpy as np
import pytest
from hypothesis import given

from semtopo.mapper import scan_world
from semtopo.scan import Scan, analyse
from semtopo.sensor import Measurement, Sensor
from semtopo.types import NOWHERE, Kind, Occupancy
from semtopo.world import Surfaces
from tests import oracle
from tests.oracle import Interval, Sample
from tests.strategies import Scene, quick, scenes

LABELS = ("a", "b", "door", "wall", "fog")
ALPHABET = (
    Sample(Kind.SPACE, "a"),
    Sample(Kind.SPACE, "b"),
    Sample(Kind.PASSAGE, "door"),
    Sample(Kind.OBSTACLE, "wall"),
    Sample(Kind.UNKNOWN, "fog"),
)


SURFACES = Surfaces(
    LABELS,
    np.arange(len(LABELS), dtype=np.intp),
    np.array([sample.kind for sample in ALPHABET], dtype=np.uint8),
)


def by_rule(words: list[tuple[Sample, ...]]) -> list[list[Interval]]:
    """Return the intervals of each word, from one call of the library: each word is a beam."""
    sensor = Sensor(beams=len(words), range=float(len(words[0])), samples=len(words[0]))
    surface = np.array([[ALPHABET.index(sample) for sample in word] for word in words])
    return spelled(analyse(Measurement(sensor, (0.0, 0.0), SURFACES, surface)))


def by_oracle(word: tuple[Sample, ...]) -> list[Interval]:
    """Return the same from the literal algorithm."""
    return oracle.intervals(word, [float(number) for number in range(1, len(word) + 1)])


@pytest.mark.parametrize("length", range(2, 8))
def test_beam_rule_on_every_sequence(length: int) -> None:
    words = list(product(ALPHABET, repeat=length))
    wrong = [
        (word, found, wanted)
        for word, found in zip(words, by_rule(words), strict=True)
        if found != (wanted := by_oracle(word))
    ]
    assert wrong == []


@pytest.mark.parametrize("length", [2, 3, 5, 7])
def test_beam_rule_on_one_beam_is_as_on_many(length: int) -> None:
    words = list(product(ALPHABET, repeat=length))[::37]
    assert [by_rule([word])[0] for word in words] == by_rule(words)


def test_what_is_kept_is_a_space_before_the_first_obstacle() -> None:
    words = list(product(ALPHABET, repeat=6))
    for word, row in zip(words, by_rule(words), strict=True):
        kinds = [sample.kind for sample in word]
        free = kinds.index(Kind.OBSTACLE) if Kind.OBSTACLE in kinds else len(kinds)
        kept = [round(radius) for piece in row for radius in (piece.near, piece.far) if radius]
        assert all(number <= free and kinds[number - 1] is Kind.SPACE for number in kept)
        stops = [piece.far for piece in row if piece.far_occupancy is Occupancy.OBSTACLE]
        assert stops in ([], [free])


def spelled(scan: Scan) -> list[list[Interval]]:
    """Return the intervals of a scan beam by beam, as the oracle says them."""
    spans = scan.intervals
    names = {NOWHERE: "", **dict(enumerate(scan.labels))}
    rows: list[list[Interval]] = [[] for _ in scan.fan.directions]
    for i in range(len(spans)):
        rows[spans.beam[i]].append(
            Interval(
                label=names[int(spans.label[i])],
                near=float(spans.near[i]),
                far=float(spans.far[i]),
                near_occupancy=Occupancy(spans.near_occupancy[i]),
                far_occupancy=Occupancy(spans.far_occupancy[i]),
                source=names[int(spans.source[i])],
                from_robot=spans.near[i] == 0,
            )
        )
    return rows


@quick
@given(scene=scenes())
def test_intervals_equal_the_oracles(scene: Scene) -> None:
    for position in scene.walk:
        scan = scan_world(scene.world, scene.sensor, position)
        wanted = oracle.analyse(scene.world, scene.sensor, position)
        assert spelled(scan) == wanted.beams
        np.testing.assert_allclose(scan.fan.directions, wanted.directions, atol=1e-15)
        assert scan.fan.ring
        assert scan.position == position


@quick
@given(scene=scenes())
def test_intervals_of_a_beam_ascend_and_start_or_end_at_a_point(scene: Scene) -> None:
    scan = scan_world(scene.world, scene.sensor, scene.walk[0])
    for beam in spelled(scan):
        for piece in beam:
            assert piece.near <= piece.far
            assert piece.from_robot == (piece.near_occupancy is Occupancy.NONE)
        for one, two in pairwise(beam):
            assert one.far < two.near


@quick
@given(scene=scenes())
def test_points_lie_at_their_distances(scene: Scene) -> None:
    scan = scan_world(scene.world, scene.sensor, scene.walk[0])
    for points, radii in (
        (scan.near_points(), scan.intervals.near),
        (scan.far_points(), scan.intervals.far),
    ):
        distances = np.linalg.norm(points - np.array(scan.position), axis=1)
        np.testing.assert_allclose(distances, radii, atol=1e-12)


@quick
@given(scene=scenes())
def test_ends_are_the_last_points_of_the_beams(scene: Scene) -> None:
    scan = scan_world(scene.world, scene.sensor, scene.walk[0])
    ends, occupancy = scan.ends()
    far, intervals = scan.far_points(), scan.intervals
    for beam in range(len(scan.fan)):
        (mine,) = np.nonzero(intervals.beam == beam)
        if len(mine) == 0:
            assert tuple(ends[beam]) == scan.position
            assert occupancy[beam] == Occupancy.NONE
        else:
            assert (ends[beam] == far[mine[-1]]).all()
            assert occupancy[beam] == intervals.far_occupancy[mine[-1]]
