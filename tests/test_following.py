"""What was noted on zones and passages follows them when they become parts of others."""

from __future__ import annotations

from collections import Counter

import pytest
from hypothesis import given
from hypothesis import strategies as st

from semtopo.answers import answer
from semtopo.atlas import Atlas
from semtopo.errors import UnknownZoneError
from semtopo.following import passage_now, zone_now
from semtopo.graph import PassageKey
from semtopo.mapper import MapState, explore
from semtopo.names import closest_names, resolve
from semtopo.notes import LabelRef, Restriction, ZoneNotes, ZoneRef
from semtopo.sensor import Sensor
from semtopo.types import Edges, Identity, MappingOptions, Passages, Point
from tests.plans import drawn
from tests.strategies import Scene, many, patient, scenes
from tests.test_instances import ROUND_A_PILLAR

ALL = MappingOptions(edges=Edges.ADJACENT, passages=Passages.ALL, identity=Identity.INSTANCE)
FIRST = MappingOptions(edges=Edges.ADJACENT, identity=Identity.INSTANCE)
WALK = [(1.5, 1.7), (9.5, 1.7), (5.5, 1.7), (5.5, 4.0)]
"""From the hall two places of the office are seen; the last step shows that they are one."""


def states(options: MappingOptions = ALL) -> list[MapState]:
    """Return the maps around a pillar, step by step; zone o-2 becomes part of o at the last."""
    walk = explore(drawn(ROUND_A_PILLAR), Sensor(180, 6.0, 60), WALK, options)
    found = [taken.state for taken in walk]
    assert list(found[-2].graph.nodes) == ["h", "o", "o-2"]
    assert list(found[-1].graph.nodes) == ["h", "o"]
    return found


def test_names_follow() -> None:
    *_, before, after = states()
    notes = {"o-2": ZoneNotes(("the nook", "desk"), "office"), "h": ZoneNotes(("hall",))}
    assert Atlas(before, notes).notes == notes
    atlas = Atlas(after, notes)
    assert atlas.notes == {"h": notes["h"], "o": notes["o-2"]}
    assert resolve(atlas, "THE nook") == ("o",)
    assert answer(atlas, "path from hall to desk").sentence.startswith("Leave h at")
    both = Atlas(after, {**notes, "o": ZoneNotes(("study", "desk"), "lab")})
    assert both.notes["o"] == ZoneNotes(("study", "desk", "the nook"), "lab")


def test_notes_that_follow_are_the_same_object_again() -> None:
    """So what is kept by them, as the names of a map, is found again."""
    after = states()[-1]
    notes = Atlas(states()[0], {"o-2": ZoneNotes(("nook",))}).notes
    assert Atlas(after, notes).notes is Atlas(after, notes).notes
    assert Atlas(after, {}).notes == {}


def test_the_id_of_a_zone_that_merged_means_what_it_is_a_part_of() -> None:
    *_, before, after = states()
    assert resolve(Atlas(before), "o-2") == ("o-2",)
    assert resolve(Atlas(after), "o-2") == resolve(Atlas(after), "O-2") == ("o",)
    assert "o-2" not in closest_names(Atlas(after), "o-3")
    with pytest.raises(UnknownZoneError):
        resolve(Atlas(states()[0]), "o-2")


@pytest.mark.parametrize("options", [ALL, FIRST], ids=["all", "first"])
def test_restrictions_follow(options: MappingOptions) -> None:
    *_, before, after = states(options)
    (passage,) = (key for key in before.graph.passages if key[:2] == ("h", "o-2"))
    made = (
        Restriction("1", ZoneRef("o-2"), factor=2.0),
        Restriction("2", passage, closed=True),
        Restriction("3", LabelRef("o"), factor=3.0),
        Restriction("4", ZoneRef("nowhere"), closed=True),
    )
    assert Atlas(before, restrictions=made).restrictions == made
    atlas = Atlas(after, restrictions=made)
    moved = ("h", "o", 1 if options is ALL else 0)
    assert [one.on for one in atlas.restrictions] == [
        ZoneRef("o"), moved, LabelRef("o"), ZoneRef("nowhere"),
    ]  # fmt: skip
    assert [one.was for one in atlas.restrictions] == [ZoneRef("o-2"), passage, None, None]
    assert atlas.limits.closed_passages == {moved}
    assert atlas.limits.zone_factors["o"] == 6.0
    assert moved in after.graph.passages


def test_an_earlier_map_has_its_notes_as_they_were() -> None:
    """Of a later graph, asked what it was then, only what has gone since is known."""
    after = states()[-1]
    early = MapState(3, after.metric, after.graph.at(3))
    notes = {"o-2": ZoneNotes(("nook",))}
    made = (Restriction("1", ZoneRef("o-2"), closed=True),)
    assert Atlas(early, notes, made).notes == notes
    assert Atlas(early, notes, made).restrictions == made


@patient
@given(scene=scenes(), options=st.sampled_from([ALL, FIRST]))
def test_every_passage_goes_where_the_graph_has_put_it(
    scene: Scene, options: MappingOptions
) -> None:
    check_followed(scene, options, Counter())


def test_scenes_have_passages_that_move() -> None:
    counts: Counter[str] = Counter()

    @many
    @given(scene=scenes())
    def count(scene: Scene) -> None:
        check_followed(scene, ALL, counts)

    count()
    assert min(counts["zones"], counts["passages"], counts["within"]) > 5, counts


def check_followed(scene: Scene, options: MappingOptions, counts: Counter[str]) -> None:
    """All that was ever known is in the map, or lies within one zone by now."""
    known: set[PassageKey] = set()
    before = MapState()
    for taken in explore(scene.world, scene.sensor, scene.walk, options):
        state = taken.state
        passages, former = state.graph.passages, state.metric.former
        for node in before.graph.nodes:
            now = zone_now(state.graph, former, node)
            counts["zones"] += now != node
            assert now in state.graph.nodes
        for key in known:
            moved = passage_now(state, key)
            counts["passages"] += moved != key
            counts["within"] += moved[0] == moved[1]
            assert moved in passages or moved[0] == moved[1]
        first: dict[PassageKey, Point] = {}  # of those that became one, the first stays
        for key, passage in before.graph.passages.items():
            first.setdefault(passage_now(state, key), passage.point)
        for key in passages.keys() & first.keys() - before.graph.passages.keys():
            assert passages[key].point == first[key]
        known |= before.graph.passages.keys()
        before = state
