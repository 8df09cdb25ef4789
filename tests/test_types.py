"""The small words: kinds and occupancies keep their numbers, poses and options refuse nonsense."""

from __future__ import annotations

import math

import pytest

from semtopo.errors import InvalidOptionError, InvalidPoseError
from semtopo.types import Edges, Kind, MappingOptions, Occupancy, Pose

NOT_FINITE = [math.nan, math.inf, -math.inf]


def test_numbers_that_stand_in_stored_maps() -> None:
    assert [(kind.name, kind.value) for kind in Kind] == [
        ("SPACE", 0), ("PASSAGE", 1), ("OBSTACLE", 2), ("UNKNOWN", 3),
    ]  # fmt: skip
    assert [(why.name, why.value) for why in Occupancy] == [
        ("NONE", 0), ("FREE", 1), ("PASSAGE", 2), ("OBSTACLE", 3),
    ]  # fmt: skip


def test_pose_has_a_position() -> None:
    assert Pose(1.0, -2.0, 0.5).position == (1.0, -2.0)


@pytest.mark.parametrize("number", NOT_FINITE)
@pytest.mark.parametrize("name", ["x", "y", "theta"])
def test_pose_refuses_what_is_not_finite(name: str, number: float) -> None:
    with pytest.raises(InvalidPoseError):
        Pose(**{"x": 0.0, "y": 0.0, name: number})


def test_options_default_to_the_paper() -> None:
    options = MappingOptions()
    assert options.edges is Edges.SEEN
    assert options.min_zone_area == 0


def test_options_take_the_word_for_edges() -> None:
    word = "adjacent"
    assert MappingOptions(edges=word).edges is Edges.ADJACENT  # type: ignore[arg-type]


@pytest.mark.parametrize("word", ["", "near", "SEEN", None, 1])
def test_options_refuse_other_words(word: object) -> None:
    with pytest.raises(InvalidOptionError, match="seen, adjacent"):
        MappingOptions(edges=word)  # type: ignore[arg-type]


@pytest.mark.parametrize("area", [-1e-9, *NOT_FINITE])
def test_options_refuse_an_area_that_is_none(area: float) -> None:
    with pytest.raises(InvalidOptionError, match="min_zone_area"):
        MappingOptions(min_zone_area=area)
