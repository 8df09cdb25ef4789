"""Answers in words and structure: on a home of simple zones, and along the paper's run."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from functools import cache
from itertools import permutations
from math import dist, isclose
from typing import get_args

import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from semtopo.answers import Answer, answer, answer_question
from semtopo.answers.values import (
    ChangesAnswer,
    ClassesAnswer,
    ConnectionAnswer,
    DistanceAnswer,
    FrontiersAnswer,
    HereAnswer,
    LocationAnswer,
    NearestAnswer,
    NeighboursAnswer,
    PathAnswer,
    ReachableAnswer,
    ReachingAnswer,
    SeenAnswer,
    ZonesAnswer,
)
from semtopo.atlas import Atlas
from semtopo.borders import border_pieces
from semtopo.codec import answer_document, to_json
from semtopo.errors import (
    AmbiguousZoneError,
    SemtopoError,
    UnknownBorderError,
    UnknownPositionError,
    UnknownStepError,
    UnknownZoneError,
)
from semtopo.errors.ways import MissingPassage, NoRouteError
from semtopo.journey import WayOptions
from semtopo.mapper import MapState, explore
from semtopo.notes import Restriction, ZoneNotes, ZoneRef
from semtopo.questions import Question
from semtopo.sensor import Sensor
from semtopo.types import Occupancy
from tests.atlases import atlas
from tests.drawn_questions import questions_about
from tests.test_paper import path as paper_path
from tests.test_paper import world as paper_world

HOME = atlas(
    [
        ("hall", "bath", (2.0, 5.0)),
        ("bath", "hall", (2.0, 5.0)),
        ("hall", "living room", (4.0, 6.0)),
        ("living room", "hall", (4.0, 6.0)),
        ("living room", "Balcony", (8.0, 7.0)),
        ("hall", "study", (2.0, 1.0)),
        ("study", "hall", (2.0, 1.0)),
        ("hall", "den", (4.0, 1.0)),
        ("den", "hall", (4.0, 1.0)),
    ],
    {
        "hall": shapely.box(2, 0, 4, 8),
        "bath": shapely.box(0, 4, 2, 6),
        "living room": shapely.box(4, 4, 8, 8),
        "Balcony": shapely.box(8, 6, 10, 8),
        "study": shapely.box(0, 0, 2, 2),
        "den": shapely.box(4, 0, 6, 2),
        "attic": shapely.box(0, 9, 2, 11),
        "desk 1": shapely.box(0, 12, 1, 13),
        "desk 2": shapely.box(2, 12, 3, 13),
    },
    labels={"desk 1": "desk", "desk 2": "desk"},
    notes={
        "study": ZoneNotes(("library", "the den of books"), "workroom"),
        "den": ZoneNotes((), "workroom"),
        "bath": ZoneNotes((), "wet room"),
    },
)
ROBOT = replace(HOME, state=replace(HOME.state, position=(3.0, 7.0), here="hall"))


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("path from hall to hall", "You are in hall already."),
        ("path from here to BATH", "Leave hall at (2.0, 5.0) into bath: 3.2 m, 1 passage."),
        (
            "path from the bath to the living room",
            (
                "Leave bath at (2.0, 5.0) into hall, then leave hall at (4.0, 6.0)"
                " into living room: 5.2 m, 2 passages."
            ),
        ),
        ("go to the library", "Leave hall at (2.0, 1.0) into study: 7.1 m, 1 passage."),
        ("how far is the study from the den", "From den to study it is 4.0 m, through 2 passages."),
        ("how far is den", "From hall to den it is 7.1 m, through 1 passage."),
        (
            "nearest workroom from the den",
            "The nearest is den. You are in den already.",
        ),
        (
            "where is the nearest workroom",
            "The nearest is study. Leave hall at (2.0, 1.0) into study: 7.1 m, 1 passage.",
        ),
        (
            "is there a way from bath to balcony avoiding the study",
            (
                "Yes. Leave bath at (2.0, 5.0) into hall, then leave hall at (4.0, 6.0)"
                " into living room, then leave living room at (8.0, 7.0) into Balcony:"
                " 8.4 m, 3 passages."
            ),
        ),
        ("where am I", "You are in hall, at (3.0, 7.0)."),
        ("where is the study", "study is at (1.0, 1.0), with 4.0 m^2."),
        (
            "where is desk",
            "desk 1 is at (0.5, 12.5), with 1.0 m^2 and desk 2 is at (2.5, 12.5), with 1.0 m^2.",
        ),
        (
            "what is next to the living room",
            "Next to living room are hall (out at (4.0, 6.0)) and Balcony (out at (8.0, 7.0)).",
        ),
        (
            "what is next to balcony",
            "Next to Balcony is living room (only the way in is known, at (8.0, 7.0)).",
        ),
        ("what is next to the attic", "Next to attic is no zone that is known."),
        ("which zones are reachable from balcony", "From Balcony one reaches no other zone."),
        (
            "which zones are reachable from bath",
            "From bath one reaches hall, living room, Balcony, study and den.",
        ),
        ("from which zones can the attic be reached", "One reaches attic from no other zone."),
        (
            "which zones lead to balcony",
            "One reaches Balcony from hall, bath, living room, study and den.",
        ),
        ("list zones of class workroom", "There are 2 zones: study and den."),
        ("list zones of class 'wet room'", "There is 1 zone: bath."),
        ("list classes", "There are wet room (1 zone) and workroom (2 zones)."),
    ],
)
def test_answers_read_as_sentences(text: str, sentence: str) -> None:
    assert answer(ROBOT, text).sentence == sentence


def test_a_tour_goes_on_where_its_legs_end() -> None:
    found = answer(ROBOT, "path from bath to study via living room and then to the nearest workroom"
                          " avoiding study and then here")  # fmt: skip
    assert isinstance(found, PathAnswer)
    assert [leg.target for leg in found.legs] == ["study", "den", "hall"]
    assert found.route.zones == (
        "bath", "hall", "living room", "hall", "study", "hall", "den", "hall",
    )  # fmt: skip
    for one, other in zip(found.legs, found.legs[1:], strict=False):
        assert one.points[-1] == other.points[0]
    assert len(found.route.points) == len(found.route.passages) + 2 + len(found.legs) - 1
    assert isclose(found.route.length, sum(leg.length for leg in found.legs))
    assert found.route.points[-1] == ROBOT.state.position


def test_restrictions_count() -> None:
    closed = replace(ROBOT, restrictions=(Restriction("r", ZoneRef("living room"), closed=True),))
    with pytest.raises(NoRouteError, match="but for what is closed or avoided") as refused:
        answer(closed, "go to balcony")
    assert refused.value.restricted
    found = answer(closed, "which zones are reachable from bath")
    assert isinstance(found, ReachableAnswer)
    assert found.zones == ("hall", "study", "den")
    found = answer(closed, "which zones lead to balcony")
    assert isinstance(found, ReachingAnswer)
    assert found.zones == ("living room",)  # who is in there may leave


def test_a_way_that_is_not_there() -> None:
    with pytest.raises(NoRouteError) as refused:
        answer(ROBOT, "path from balcony to bath")
    assert str(refused.value).startswith(
        "There is no way from Balcony to bath yet: Balcony -> living room is not known, though"
        " living room -> Balcony has been since step 5. Balcony was only looked into, from"
        " living room. From Balcony one reaches no other zone. One reaches bath from hall,"
        " living room, study and den. With two_way, passages are used against their direction too,"
        " and there is a way."
    )
    assert refused.value.two_way
    assert refused.value.missing == MissingPassage("Balcony", "living room", 5)
    found = answer(ROBOT, "is there a way from balcony to bath")
    assert isinstance(found, ConnectionAnswer)
    assert found.sentence == f"No. {refused.value}"
    assert (found.connected, found.route) == (False, None)
    assert found.gap is not None
    assert found.gap.missing == refused.value.missing
    assert found.gap.two_way
    with pytest.raises(NoRouteError, match="from Balcony to bath via hall avoiding den and study"):
        answer(ROBOT, "path from balcony to bath via hall avoiding workroom")


@pytest.mark.parametrize(
    ("text", "position", "closest"),
    [
        ("path from hal to bath", 10, "hall"),
        ("path from hall to the baths", 22, "bath"),
        ("path from hall to bath via hall and livingroom", 36, "living room"),
        ('path from hall to bath avoiding "balkony"', 32, "Balcony"),
        ("nearest workrom", 8, "workroom"),
        ("where is the labrary", 13, "library"),
        ("list zones of class workrooms", 20, "workroom"),
        ("what is next to atic", 16, "attic"),
        ("which zones lead to studdy", 20, "study"),
        ("is there a way from bath to hell", 28, "hall"),
    ],
)
def test_unknown_names_are_placed(text: str, position: int, closest: str) -> None:
    with pytest.raises(UnknownZoneError) as refused:
        answer(ROBOT, text)
    assert (refused.value.position, refused.value.closest[0]) == (position, closest)
    assert f"character {position + 1}" in str(refused.value)
    assert closest in str(refused.value)
    assert refused.value.facts["position"] == position


def test_a_name_like_no_other() -> None:
    with pytest.raises(UnknownZoneError, match='Ask "list zones"') as refused:
        answer(ROBOT, "go to xyzzy")
    assert refused.value.closest == ()


def test_names_of_several_zones() -> None:
    with pytest.raises(AmbiguousZoneError, match="desk 1 or desk 2") as refused:
        answer(ROBOT, "path from desk to hall")
    assert (refused.value.position, refused.value.candidates) == (10, ("desk 1", "desk 2"))
    near = answer(ROBOT, "path from hall to workroom")  # the nearest of a class, as a goal
    assert isinstance(near, PathAnswer)
    assert near.route.target in {"study", "den"}


def test_where_the_robot_is_may_not_be_known() -> None:
    for text in ("where am I", "go to bath", "what is next to here", "nearest workroom"):
        with pytest.raises(UnknownPositionError, match="no step"):
            answer(HOME, text)
    lost = replace(HOME, state=replace(HOME.state, position=(50.0, 50.0)))
    found = answer(lost, "where am I")
    assert isinstance(found, HereAnswer)
    assert (found.zone, found.position) == (None, (50.0, 50.0))
    assert found.sentence.startswith("You are at (50.0, 50.0).")
    with pytest.raises(UnknownPositionError, match="saw none"):
        answer(lost, "go to bath")
    placed = replace(HOME, state=replace(HOME.state, here="hall"))
    assert answer(placed, "where am I").sentence == "You are in hall."
    assert answer(placed, "go to bath").sentence.startswith("Leave hall at")


def test_a_way_from_beside_a_zone_begins_at_its_border() -> None:
    beside = replace(HOME, state=replace(HOME.state, position=(3.0, 9.0), here="hall"))
    found = answer(beside, "go to bath")
    assert isinstance(found, PathAnswer)
    assert found.route.points[0] == (3.0, 8.0)


def test_an_empty_map() -> None:
    nothing = Atlas(MapState())
    assert answer(nothing, "list zones").sentence == "No zone is known yet."
    assert answer(nothing, "list classes").sentence == "No zone has a class yet."
    changed = answer(nothing, "what changed since step 0")
    assert changed.sentence == "Between step 0 and step 0: nothing changed."
    for text in ("what did I see at step 1", "what did I see at step 0", "what changed since 1"):
        with pytest.raises(UnknownStepError):
            answer(nothing, text)
    with pytest.raises(UnknownZoneError):
        answer(nothing, "where is a")


def test_maps_without_borders_have_no_frontiers() -> None:
    with pytest.raises(UnknownBorderError):
        answer(HOME, "what is unexplored in hall")


def test_sentences_stay_short() -> None:
    row = [(f"r{n}", f"r{n + 1}", (float(n), 0.0)) for n in range(60)]
    long = atlas(row)
    assert answer(long, "list zones").sentence.endswith("r18, r19 and 41 more.")
    path = answer(long, "path from r0 to r60")
    assert isinstance(path, PathAnswer)
    assert len(path.route.passages) == 60
    assert "40 passages more" in path.sentence
    assert path.sentence.count("leave") + path.sentence.count("Leave") == 20


@cache
def drive() -> list[MapState]:
    """Return the maps of the paper's run, from none to 81."""
    steps = explore(paper_world(), Sensor(beams=72, range=2.0, samples=20), paper_path())
    return [MapState(), *(step.state for step in steps)]


def ask(seq: int, text: str) -> Answer:
    return answer(Atlas(drive()[seq]), text, drive().__getitem__)


def test_a_zone_with_the_robot_in_it_was_more_than_looked_into() -> None:
    inside = replace(ROBOT, state=replace(ROBOT.state, here="Balcony"))
    with pytest.raises(NoRouteError) as refused:
        answer(inside, "path from balcony to bath")
    assert "looked into" not in str(refused.value)


def test_a_zone_that_was_looked_into_by_two_doors_was_looked_into_from_one_zone() -> None:
    twice = atlas([("hall", "den", (0, 0)), ("hall", "den", (5, 0), 1), ("hall", "bath", (9, 0))])
    with pytest.raises(NoRouteError, match=r"only looked into, from hall\."):
        answer(twice, "path from den to bath")


def test_what_two_way_promises_it_keeps() -> None:
    both = WayOptions(two_way=True)
    found = answer(ROBOT, "path from balcony to bath", options=both)
    assert isinstance(found, PathAnswer)
    assert found.route.backwards[0].target == "Balcony"
    with pytest.raises(NoRouteError) as refused:
        answer(ROBOT, "path from attic to bath", options=both)
    assert not refused.value.two_way
    assert "two_way" not in str(refused.value)


def test_the_paper_at_step_29() -> None:
    with pytest.raises(NoRouteError) as refused:
        ask(29, "path from corridor to C")
    assert refused.value.missing == MissingPassage("corridor", "C", 29)
    assert (refused.value.reachable, refused.value.reaching) == (("corridor", "A"), ("C",))
    frontier = refused.value.frontier
    assert frontier is not None
    assert frontier.zone_id in refused.value.reachable
    assert str(refused.value) == (
        "There is no way from corridor to C yet: corridor -> C is not known, though C -> corridor"
        " has been since step 29. From corridor one reaches A. One reaches C from no other zone."
        " With two_way, passages are used against their direction too, and there is a way."
        " The frontier nearest to closing the gap is at"
        f" ({frontier.point[0]:.1f}, {frontier.point[1]:.1f}) in {frontier.zone_id}."
    )
    assert ask(29, "is C reachable from corridor").sentence == f"No. {refused.value}"


@pytest.mark.parametrize("seq", range(30, 66, 5))
def test_the_paper_until_step_66(seq: int) -> None:
    with pytest.raises(NoRouteError, match="C -> corridor has been since step 29"):
        ask(seq, "path from corridor to C")


def test_the_paper_at_step_66() -> None:
    found = ask(66, "path from corridor to C")
    assert isinstance(found, PathAnswer)
    assert re.fullmatch(r"Leave corridor at \(8\.9, 4\.3\) into C: \d+\.\d m, 1 passage\.",
                        found.sentence)  # fmt: skip


def test_the_paper_at_step_81() -> None:
    """Every ordered pair of the five zones is answered, and the answers agree with each other."""
    zones = drive()[81].graph.nodes
    assert set(zones) == {"corridor", "A", "B", "C", "D"}
    for start, goal in permutations(zones, 2):
        found = ask(81, f"path from {start} to {goal}")
        assert isinstance(found, PathAnswer)
        assert (found.route.source, found.route.target) == (start, goal)
        straight = dist(found.route.points[0], found.route.points[-1])
        assert found.route.length >= straight - 1e-9
        far = ask(81, f"how far is {goal} from {start}")
        assert isinstance(far, DistanceAnswer)
        assert far.length == found.route.length
        link = ask(81, f"is {goal} reachable from {start}")
        assert isinstance(link, ConnectionAnswer)
        assert link.connected
        assert link.route == found.route


@pytest.mark.parametrize("seq", [1, 5, 29, 42, 66, 81])
def test_reachability_is_that_of_routes(seq: int) -> None:
    zones = list(drive()[seq].graph.nodes)
    for start in zones:
        spread = ask(seq, f"which zones are reachable from {start}")
        assert isinstance(spread, ReachableAnswer)
        linked = [ask(seq, f"is there a way from {start} to {goal}") for goal in zones]
        assert [it.connected for it in linked if isinstance(it, ConnectionAnswer)] == [
            goal == start or goal in spread.zones for goal in zones
        ]
        for goal in zones:
            back = ask(seq, f"from which zones can {goal} be reached")
            assert isinstance(back, ReachingAnswer)
            assert (start in back.zones) == (goal in spread.zones)


def test_what_was_seen_is_what_each_step_found() -> None:
    for seq in range(1, 82):
        state, found = drive()[seq], ask(81, f"what did I see at step {seq}")
        before = drive()[seq - 1]
        assert isinstance(found, SeenAnswer)
        assert (found.step, found.zone, found.position) == (seq, state.here, state.position)
        assert set(found.zones) == set(state.graph.nodes) - set(before.graph.nodes)
        new = set(state.graph.passages) - set(before.graph.passages)
        assert {one.key for one in found.passages} == new
        zones = before.metric.zones
        assert found.grown is not None
        assert set(found.grown) == {
            key for key, zone in zones.items() if zone is not state.metric.zones[key]
        }


@given(st.integers(0, 81), st.integers(0, 81))
@settings(max_examples=40)
def test_changes_are_those_between_two_maps(one: int, other: int) -> None:
    found = ask(81, f"what changed between step {one} and {other}")
    assert isinstance(found, ChangesAnswer)
    since, until = sorted((one, other))
    assert (found.since, found.until) == (since, until)
    before, after = drive()[since], drive()[until]
    assert set(found.zones) == set(after.graph.nodes) - set(before.graph.nodes)
    assert len(found.passages) == len(after.graph.passages) - len(before.graph.passages)
    assert found.gone == ()
    areas = {key: zone.region.area for key, zone in after.metric.zones.items()}
    assert found.grown is not None
    for growth in found.grown:
        assert growth.before == before.metric.zones[growth.zone].region.area
        assert growth.before < growth.after == areas[growth.zone]
    told = {growth.zone for growth in found.grown}
    same = [key for key in before.metric.zones if key not in told]
    assert all(isclose(before.metric.zones[key].region.area, areas[key]) for key in same)
    assert ("nothing changed" in found.sentence) == (before.metric.zones == after.metric.zones)


def test_changes_until_now_and_steps_to_come() -> None:
    assert ask(81, "what changed since step 60") == ask(81, "what changed between 60 and 81")
    for text in ("what changed since step 82", "what did I see at step 82",
                 "what changed between step 5 and 999999999"):  # fmt: skip
        with pytest.raises(UnknownStepError, match="last step was 81"):
            ask(81, text)
    with pytest.raises(UnknownStepError, match="earlier"):
        answer(Atlas(drive()[81]), "what did I see at step 5")
    assert answer(Atlas(drive()[81]), "what did I see at step 81").sentence


def test_frontiers_are_the_free_pieces_of_the_border() -> None:
    for seq, zone in ((5, "A"), (29, "corridor"), (81, "corridor")):
        found = ask(seq, f"what is unexplored in {zone}")
        assert isinstance(found, FrontiersAnswer)
        pieces = border_pieces(drive()[seq].metric.zones[zone])
        free = [shapely.LineString(it.line) for it in pieces if it.occupancy is Occupancy.FREE]
        assert found.frontiers
        lengths = [one.length for one in found.frontiers]
        assert lengths == sorted((line.length for line in free), reverse=True)
        lines = shapely.union_all(free)
        assert all(lines.distance(shapely.Point(one.point)) < 1e-9 for one in found.frontiers)
        assert f"{found.frontiers[0].length:.1f} m" in found.sentence


names = st.sampled_from(["corridor", "A", "B", "C", "D", "c", "E", "corridr", "", "\n", "d" * 500])


@given(questions_about(names, st.integers(0, 90)), st.sampled_from([0, 1, 29, 81]))
@settings(max_examples=300)
def test_any_question_is_answered_or_refused(question: Question, seq: int) -> None:
    """Whatever the names: what is answered can be written, what is refused has a sentence."""
    found = tried(Atlas(drive()[seq]), question)
    if isinstance(found, SemtopoError):
        assert type(found) is not SemtopoError
        assert str(found).endswith(".")
        assert to_json(dict(found.facts))
    else:
        assert json.loads(to_json(answer_document(found)))["sentence"] == found.sentence


def tried(atlas: Atlas, question: Question) -> Answer | SemtopoError:
    try:
        return answer_question(atlas, question, drive().__getitem__)
    except SemtopoError as refused:
        return refused


KINDS = [
    ("path from A to C", PathAnswer), ("is there a way from A to C", ConnectionAnswer),
    ("how far is A from C", DistanceAnswer), ("nearest C", NearestAnswer),
    ("where am I", HereAnswer), ("where is C", LocationAnswer),
    ("what is next to C", NeighboursAnswer), ("which zones are reachable from C", ReachableAnswer),
    ("which zones lead to C", ReachingAnswer), ("what did I see at step 3", SeenAnswer),
    ("what changed since 3", ChangesAnswer), ("list zones", ZonesAnswer),
    ("list classes", ClassesAnswer), ("what is unexplored in C", FrontiersAnswer),
]  # fmt: skip


@pytest.mark.parametrize(("text", "kind"), KINDS)
def test_every_kind_of_answer_can_be_written(text: str, kind: type) -> None:
    found = ask(81, text)
    assert type(found) is kind
    written = json.loads(to_json(answer_document(found)))
    assert list(written)[:2] == ["kind", "sentence"]
    assert written["kind"] == found.kind
    assert written["sentence"].endswith(".")
    assert written["sentence"][0].isupper()


def test_no_two_kinds_share_a_name() -> None:
    kinds = [kind.kind for kind in get_args(Answer)]
    assert len(set(kinds)) == len(kinds) == len(KINDS)
    assert {kind for _, kind in KINDS} == set(get_args(Answer))
