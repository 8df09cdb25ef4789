"""Ways in answers as a robot goes them: with a path for its width, and by passages both ways."""

from __future__ import annotations

import re
from dataclasses import replace

import pytest
import shapely

from semtopo.answers import answer
from semtopo.answers.values import ConnectionAnswer, NearestAnswer, PathAnswer
from semtopo.atlas import Atlas
from semtopo.doorways import Doorway, Doorways
from semtopo.errors import InvalidOptionError
from semtopo.errors.ways import (
    GroundlessPassage,
    NoRouteError,
    NotConnectedError,
    TooNarrowError,
)
from semtopo.journey import WayOptions
from tests.atlases import Edge, atlas

ZONES = {
    "a": shapely.box(0, 0, 3.9, 4), "hall": shapely.box(4.1, 0, 7.9, 4),
    "b": shapely.box(8.1, 0, 12, 4),
}  # fmt: skip


def hall(gap: float = 1.0) -> Atlas:
    """Return a hall between two rooms; into a room one only knows the way from it.

    The doorways are so wide, in m; with 0, there are none.
    """
    edges: list[Edge] = [("hall", "a", (4.0, 2.0)), ("hall", "b", (8.0, 2.0))]
    place = atlas(edges, ZONES)
    doors = {
        (*ends, 0): Doorway(ends, 0, shapely.box(x - 0.2, 2 - gap / 2, x + 0.2, 2 + gap / 2), 1, 1)
        for ends, x in ((("a", "hall"), 4.0), (("b", "hall"), 8.0))
        if gap > 0
    }
    metric = replace(place.state.metric, doorways=Doorways(doors))
    return replace(place, state=replace(place.state, metric=metric))


def masked(sentence: str) -> str:
    """Return a sentence without lengths: the middle of a zone is where it is within 1 %."""
    return re.sub(r"4\.[01] m|8\.[01] m", "# m", sentence)


def test_a_way_against_the_direction_of_a_passage_says_so() -> None:
    with pytest.raises(NoRouteError):
        answer(hall(), "path from a to b")
    found = answer(hall(), "path from a to b", options=WayOptions(two_way=True))
    assert masked(found.sentence) == (
        "Leave a at (4.0, 2.0) into hall, against the direction in which it is known, then leave"
        " hall at (8.0, 2.0) into b: # m, 2 passages."
    )
    assert isinstance(found, PathAnswer)
    assert [it.source for it in found.route.backwards] == ["hall"]


@pytest.mark.parametrize(
    ("text", "beginning"),
    [
        ("path from hall to b", ""),
        ("is there a way from hall to b", "Yes. "),
        ("nearest b from hall", "The nearest is b. "),
    ],
)
def test_for_a_robot_a_way_has_a_path(text: str, beginning: str) -> None:
    found = answer(hall(), text, options=WayOptions(radius=0.3))
    way = "Leave hall at (8.0, 2.0) into b: # m, 1 passage. The path for the robot is # m long."
    assert masked(found.sentence) == beginning + way
    assert isinstance(found, PathAnswer | ConnectionAnswer | NearestAnswer)
    assert found.route is not None
    assert found.route.path is not None
    assert found.route.path.clearance >= 0.3


def test_the_path_of_a_tour_is_in_one_piece() -> None:
    options = WayOptions(radius=0.3, two_way=True)
    found = answer(hall(), "path from a to b and then to a and then to hall", options=options)
    assert isinstance(found, PathAnswer)
    paths = [leg.path for leg in found.legs if leg.path is not None]
    whole = found.route.path
    assert whole is not None
    assert len(paths) == len(found.legs) == 3
    assert whole.length == pytest.approx(sum(path.length for path in paths))
    assert whole.length == pytest.approx(shapely.LineString(whole.points).length)
    assert whole.clearance == min(path.clearance for path in paths)


def test_a_robot_that_does_not_fit_is_told_where() -> None:
    with pytest.raises(
        TooNarrowError, match=r"this robot: at .* it is (0\.499|0\.500) m wide, and"
    ):
        answer(hall(gap=0.5), "path from hall to b", options=WayOptions(radius=0.3))
    with pytest.raises(NotConnectedError, match="between hall and b: the passage at") as refused:
        answer(hall(gap=0.0), "path from hall to b", options=WayOptions(radius=0.3))
    assert refused.value.passage == GroundlessPassage("hall", "b", (8.0, 2.0))
    with pytest.raises(InvalidOptionError, match="radius"):
        WayOptions(radius=-1.0)
