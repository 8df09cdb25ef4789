"""Questions in words: which are understood, what they mean, and how the answer reads."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from semtopo.atlas import Atlas
from semtopo.errors import InvalidQuestionError, NoRouteError, UnknownZoneError
from semtopo.graph import Node, Passage, TopologyGraph
from semtopo.mapper import MapState
from semtopo.metric import MappedZone, MetricMap
from semtopo.query import PathQuestion, answer, describe, parse
from semtopo.route import Route
from semtopo.zones import Border


@pytest.mark.parametrize(
    ("text", "source", "target"),
    [
        ("path from corridor to C", "corridor", "C"),
        ("Path from corridor to C.", "corridor", "C"),
        ("PATH FROM corridor TO C", "corridor", "C"),
        ("the path from a to b?", "a", "b"),
        ("A path from a to b!", "a", "b"),
        ("  path   from   a   to   b  ", "a", "b"),
        ("path\tfrom a\nto b", "a", "b"),
        ("path from living room to kitchen", "living room", "kitchen"),
        ('path from "living room" to "the kitchen"', "living room", "the kitchen"),
        ('path from "way to go" to b', "way to go", "b"),
        ('path from a to "way to go"', "a", "way to go"),
        ('path from "a to b" to "c to d"?', "a to b", "c to d"),
        ('path from "path from x to y" to z', "path from x to y", "z"),
        ("path from Küche to 厨房", "Küche", "厨房"),
        ("path from 🤖 to é", "🤖", "é"),
        ("path from a to to b", "a", "to b"),
        ("path from tomato to potato", "tomato", "potato"),
        ("path from r1-1 to r1-2", "r1-1", "r1-2"),
        ('path from "C." to "D?"', "C.", "D?"),
        ('path from " a " to b', "a", "b"),
        ("path from O'Brien's to b", "O'Brien's", "b"),
        ("path from a to a", "a", "a"),
        ("path from path to from", "path", "from"),
        ("path from a to b to", "a", "b to"),
    ],
)
def test_forms_that_are_understood(text: str, source: str, target: str) -> None:
    assert parse(text) == PathQuestion(source, target)


@pytest.mark.parametrize(
    "text",
    [
        "", " ", "path", "path from", "path from a", "path from a to", "path from a to ",
        "path to b", "path from to b", "route from a to b", "how do I get from a to b",
        "path from a b", "patha from a to b", "path froma to b", "path from ato b",
        "from a to b", '"path from a to b"',
    ],
)  # fmt: skip
def test_forms_that_are_not(text: str) -> None:
    with pytest.raises(InvalidQuestionError):
        parse(text)


names = st.text(
    st.characters(exclude_categories=["C", "Z"], exclude_characters='"'), min_size=1, max_size=12
)


@given(source=names, target=names)
def test_any_name_may_stand_in_quotes(source: str, target: str) -> None:
    assert parse(f'path from "{source}" to "{target}"') == PathQuestion(source, target)


@given(st.text(max_size=60))
def test_no_text_breaks_it(text: str) -> None:
    for question in (text, f"path from {text}", f"path from {text} to {text}"):
        try:
            parse(question)
        except InvalidQuestionError:
            continue


def atlas(*edges: tuple[str, str, tuple[float, float]]) -> Atlas:
    """Return zones that are all the same square, with passages."""
    zones = dict.fromkeys(zone for source, target, _ in edges for zone in (source, target))
    nodes = {zone: Node(zone, zone, 1) for zone in zones}
    found = [Passage(source, target, it, 1) for source, target, it in edges]
    passages = {passage.key: passage for passage in found}
    region, border = shapely.box(-16, -16, 16, 16), Border(np.empty((0, 2)), np.empty(0, np.uint8))
    mapped = {zone: MappedZone(zone, zone, region, border, 1, 1) for zone in zones}
    return Atlas(MapState(1, MetricMap(mapped), TopologyGraph(nodes, passages)))


HOME = atlas(
    ("hall", "bath", (1.0, 2.0)), ("hall", "living room", (4.0, 6.0)),
    ("bath", "hall", (1.0, 2.26)), ("living room", "Balcony", (-1.0, 12.345)),
)  # fmt: skip


@pytest.mark.parametrize(
    ("question", "sentence"),
    [
        ("path from hall to hall", "You are in hall already."),
        ("path from bath to HALL", "Leave bath at (1.0, 2.3) into hall: 4.9 m, 1 passage."),
        (
            "path from bath to living room",
            """Leave bath at (1.0, 2.3) into hall, then leave hall at (4.0, 6.0) into living room:
            14.5 m, 2 passages.""",
        ),
        (
            "path from hall to balcony",
            """Leave hall at (4.0, 6.0) into living room, then leave living room at (-1.0, 12.3)
            into Balcony: 27.7 m, 2 passages.""",
        ),
    ],
)
def test_answers_read_as_sentences(question: str, sentence: str) -> None:
    found = answer(HOME, question)
    assert found.sentence == " ".join(sentence.split()) == describe(found.route)


def test_an_answer_holds_the_route() -> None:
    found = answer(HOME, 'path from "BATH" to "living room"').route
    assert isinstance(found, Route)
    assert found.zones == ("bath", "hall", "living room")


def test_answers_that_cannot_be_given() -> None:
    with pytest.raises(UnknownZoneError):
        answer(HOME, "path from hall to kitchen")
    with pytest.raises(NoRouteError):
        answer(HOME, "path from balcony to hall")
    with pytest.raises(InvalidQuestionError):
        answer(HOME, "where is the kitchen?")
    with pytest.raises(UnknownZoneError):
        answer(Atlas(MapState()), "path from a to b")
