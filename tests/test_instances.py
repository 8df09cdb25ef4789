"""Zones as instances (R14) and passages by their doorways (R10): what holds after every step."""

from __future__ import annotations

from collections import Counter
from itertools import permutations

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from shapely import box

from semtopo.fusion import Extent
from semtopo.geometry import Region
from semtopo.graph import (
    NodeFound,
    NodeMerged,
    PassageFound,
    PassageJoined,
    TopologyGraph,
)
from semtopo.mapper import MapState, Step, explore, run
from semtopo.metric import MetricMap
from semtopo.placement import Placement, place
from semtopo.runs import LabelledRuns, from_runs
from semtopo.sensor import Sensor
from semtopo.sensor_map import SensorMap
from semtopo.types import Edges, Identity, Kind, MappingOptions, Passages, Point, Pose
from semtopo.world import World
from semtopo.zones import Zone
from tests.plans import TWO_DOORS, drawn
from tests.strategies import Scene, instances, labelled_runs, many, patient, poses, scenes

FINE = Sensor(beams=180, range=6.0, samples=60)
SEEN = MappingOptions(identity=Identity.INSTANCE)
EACH = MappingOptions(edges=Edges.ADJACENT, identity=Identity.INSTANCE, passages=Passages.ALL)

TWO_OFFICES = """
    #########
    #ooo#ooo#
    #ooo#ooo#
    #+######+
    #hhhhhhh+
    #hhhhhhh#
    #########
"""
"""Two offices `o` at a hall `h`, the second behind a door to the right of the wall."""

ROUND_A_PILLAR = """
    ###########
    #ooooooooo#
    #ooooooooo#
    #+#######+#
    #hhhhhhhhh#
    ###########
"""
"""One office with two doors to a hall: from the hall one sees two parts of it."""

doors = st.builds(MappingOptions, edges=st.sampled_from(Edges), passages=st.just(Passages.ALL))
"""Mapping options with zones by label, and all passages."""


def seen(here: str, *zones: tuple[str, Region]) -> SensorMap:
    """Return a sensor map of some regions; of one label, the parts in the order given."""
    parts: Counter[str] = Counter()
    made = []
    for label, region in zones:
        made.append(Zone(label, Extent.of(region), parts[label]))
        parts[label] += 1
    return SensorMap((99.0, 99.0), tuple(sorted(made, key=lambda zone: zone.name)), here, ())


def placed(*scans: SensorMap) -> list[Placement]:
    """Return the placements of scans, one after the other, in an empty map."""
    metric, found = MetricMap(), []
    for seq, scan in enumerate(scans, start=1):
        found.append(place(metric, scan, MappingOptions(identity=Identity.INSTANCE), seq))
        metric = found[-1].metric
    return found


def drive(world: World, path: list[Point], options: MappingOptions) -> list[Step]:
    return list(explore(world, FINE, path, options))


def test_places_that_do_not_touch_are_zones_of_their_own() -> None:
    first, second = placed(
        seen("o", ("o", box(0, 0, 1, 1)), ("o", box(5, 0, 6, 1))),
        seen("o", ("o", box(9, 0, 10, 1))),
    )
    assert list(first.metric.zones) == ["o", "o-2"]
    assert first.names == {("o", 0): "o", ("o", 1): "o-2"}
    assert first.here == "o"
    assert list(second.metric.zones) == ["o", "o-2", "o-3"]
    assert second.here == "o-3"
    assert {zone.label for zone in second.metric.zones.values()} == {"o"}


def test_what_touches_a_zone_is_part_of_it() -> None:
    _, second, third = placed(
        seen("o", ("o", box(0, 0, 1, 1))),
        seen("o", ("o", box(1, 0, 2, 1))),
        seen("o", ("o", box(2, 1, 3, 2))),  # by a corner
    )
    assert list(second.metric.zones) == ["o"]
    assert second.metric.zones["o"].region.equals(box(0, 0, 2, 1))
    assert list(third.metric.zones) == ["o"]
    assert (third.metric.zones["o"].since, third.metric.zones["o"].seq) == (1, 3)


def test_zones_that_a_third_joins_merge_into_the_first() -> None:
    first, second = placed(
        seen("o", ("o", box(0, 0, 1, 1)), ("o", box(3, 0, 4, 1)), ("o", box(6, 0, 7, 1))),
        seen("o", ("o", box(3.5, 0, 6.5, 1))),
    )
    assert list(first.metric.zones) == ["o", "o-2", "o-3"]
    assert second.merges == {"o-3": "o-2"}
    assert dict(second.metric.former) == {"o-3": "o-2"}
    assert list(second.metric.zones) == ["o", "o-2"]
    assert second.metric.zones["o-2"].region.equals(box(3, 0, 7, 1))
    assert second.here == "o-2"


def test_ids_are_never_used_again() -> None:
    *_, last = placed(
        seen("o", ("o", box(0, 0, 1, 1)), ("o", box(3, 0, 4, 1))),
        seen("o", ("o", box(0.5, 0, 3.5, 1))),
        seen("o", ("o", box(9, 0, 10, 1))),
    )
    assert list(last.metric.zones) == ["o", "o-3"]


def test_ids_do_not_clash_with_labels_that_look_like_them() -> None:
    *_, last = placed(
        seen("o", ("o", box(0, 0, 1, 1)), ("o", box(3, 0, 4, 1))),
        seen("o-2", ("o-2", box(0, 5, 1, 6)), ("o-2", box(3, 5, 4, 6))),
        seen("o", ("o", box(9, 0, 10, 1))),
    )
    assert list(last.metric.zones) == ["o", "o-2", "o-2-2", "o-2-3", "o-3"]
    labels = [zone.label for zone in last.metric.zones.values()]
    assert labels == ["o", "o", "o-2", "o-2", "o"]


def test_labels_that_touch_do_not_merge() -> None:
    (only,) = placed(seen("a", ("a", box(0, 0, 1, 1)), ("b", box(1, 0, 2, 1))))
    assert list(only.metric.zones) == ["a", "b"]


def touching_parts(region: Region) -> int:
    """Return in how many places a region is."""
    parts = list(shapely.get_parts(region))
    places = 0
    while parts:
        places += 1
        group = [parts.pop()]
        for member in group:
            near = [part for part in parts if part.distance(member) < 1e-9]
            parts = [part for part in parts if part not in near]
            group += near
    return places


def check_state(state: MapState) -> None:
    """Instances are places; edges have two ends, and no pair more than it may."""
    metric, graph = state.metric, state.graph
    assert list(metric.zones) == list(graph.nodes)
    assert not metric.former.keys() & metric.zones.keys()
    assert set(metric.former.values()) <= metric.zones.keys() | metric.former.keys()
    for zone in metric.zones.values():
        assert zone.region.is_valid
        assert touching_parts(zone.region) == 1
        assert 1 <= zone.since <= zone.seq <= state.seq
        for other in metric.zones.values():
            if other is not zone and other.label == zone.label:
                assert not other.region.intersects(zone.region)
    for key, passage in graph.passages.items():
        assert key == passage.key
        assert passage.source != passage.target
        assert {passage.source, passage.target} <= graph.nodes.keys()
        assert max(passage.seq, passage.moved) <= state.seq
    for key, door in metric.doorways.items():
        assert key == door.key
        assert set(door.ends) <= metric.zones.keys()
        for twin in metric.doorways.between(*door.ends):
            assert twin is door or not twin.region.intersects(door.region)
    assert state.here is None or state.here in metric.zones


def check_same_graph(one: TopologyGraph, other: TopologyGraph) -> None:
    assert list(one.nodes.items()) == list(other.nodes.items())
    assert list(one.passages.items()) == list(other.passages.items())
    assert one.gone == other.gone


def follow(graph: TopologyGraph, taken: Step) -> None:
    """Check that a step's events lead from one graph to the next."""
    nodes, edges = set(graph.nodes), set(graph.passages)
    for event in taken.events:
        match event:
            case NodeMerged():
                nodes.remove(event.zone_id)
                assert event.into in nodes
                moving = {key for key in edges if event.zone_id in key[:2]}
                edges -= moving
            case PassageJoined():
                edges.discard((event.source, event.target, event.number))
                edges.add((event.source, event.target, event.into))
            case NodeFound():
                assert event.zone_id not in nodes
                nodes.add(event.zone_id)
            case PassageFound():
                assert (event.source, event.target, event.number) not in edges
                edges.add((event.source, event.target, event.number))
    assert nodes == set(taken.state.graph.nodes)
    moved = {key for key, it in taken.state.graph.passages.items() if it.moved == taken.state.seq}
    assert edges | moved == set(taken.state.graph.passages)


def check_run(steps: list[Step], options: MappingOptions) -> None:
    """Check every state of a run, and that each can be told from the last."""
    graphs = [TopologyGraph()]
    for taken in steps:
        if options.identity is Identity.INSTANCE:
            check_state(taken.state)
        if options.passages is Passages.FIRST:
            assert {key[2] for key in taken.state.graph.passages} <= {0}
        here = taken.state.here
        assert taken.here == (None if here is None else taken.state.metric.zones[here].label)
        follow(graphs[-1], taken)
        graphs.append(taken.state.graph)
    for seq, graph in enumerate(graphs):
        check_same_graph(graphs[-1].at(seq), graph)


@patient
@given(scene=scenes(walk=6), options=st.one_of(instances, doors))
def test_what_holds_after_every_step_in_a_world(scene: Scene, options: MappingOptions) -> None:
    check_run(list(explore(scene.world, scene.sensor, scene.walk, options)), options)


@patient
@given(
    seen=st.lists(labelled_runs(), min_size=1, max_size=3),
    at=st.lists(poses, min_size=4, max_size=6),
    options=st.one_of(instances, doors),
)
def test_what_holds_after_every_step_of_a_real_robot(
    seen: list[LabelledRuns], at: list[Pose], options: MappingOptions
) -> None:
    scans = [from_runs(pose, seen[number % len(seen)]) for number, pose in enumerate(at)]
    check_run(list(run(scans, options)), options)


@patient
@given(scene=scenes(), options=instances)
def test_instances_together_are_the_zones_by_label(scene: Scene, options: MappingOptions) -> None:
    by_label = MappingOptions(edges=options.edges)
    same = MappingOptions(edges=options.edges, passages=options.passages, identity=options.identity)
    *_, whole = explore(scene.world, scene.sensor, scene.walk, by_label)
    *_, split = explore(scene.world, scene.sensor, scene.walk, same)
    labels = {zone.label for zone in split.state.metric.zones.values()}
    assert labels == whole.state.metric.zones.keys()
    for label, zone in whole.state.metric.zones.items():
        mine = [it.region for it in split.state.metric.zones.values() if it.label == label]
        assert shapely.union_all(mine).symmetric_difference(zone.region).area < 1e-7
        assert len(mine) == touching_parts(zone.region)


@patient
@given(scene=scenes())
def test_the_order_of_steps_does_not_decide_what_is_one_place(scene: Scene) -> None:
    found = [
        sorted(
            (zone.label, round(zone.region.area, 6))
            for zone in list(explore(scene.world, scene.sensor, walk, SEEN))[
                -1
            ].state.metric.zones.values()
        )
        for walk in list(permutations(scene.walk))[:3]
    ]
    assert all(one == found[0] for one in found)


def test_runs_with_instances_are_not_vacuous() -> None:
    """Of the drawn scenes, many show one label in several places, and some join them later."""
    counts: Counter[str] = Counter()

    @many
    @given(scene=scenes(walk=6))
    def count(scene: Scene) -> None:
        *_, last = explore(scene.world, scene.sensor, scene.walk, EACH)
        metric, graph = last.state.metric, last.state.graph
        counts["all"] += 1
        counts["several"] += len({it.label for it in metric.zones.values()}) < len(metric.zones)
        counts["merged"] += len(metric.former) > 0
        counts["moved"] += any(passage.moved for passage in graph.passages.values())
        counts["gone"] += len(graph.gone) > 0
        counts["parallel"] += any(key[2] > 0 for key in graph.passages)

    count()
    assert counts["several"] > 0.5 * counts["all"]
    assert counts["merged"] > 0.15 * counts["all"]
    assert counts["moved"] > 0.08 * counts["all"]
    assert counts["parallel"] > 0.06 * counts["all"]


def test_a_passage_through_each_doorway() -> None:
    """With all passages, two doors are two edges each way, with points of their own."""
    walk: list[Point] = [(1.5, 3.5), (7.5, 3.5), (1.5, 1.5), (7.5, 1.5)]
    chosen = MappingOptions(edges=Edges.ADJACENT, passages=Passages.ALL)
    *_, last = drive(drawn(TWO_DOORS), walk, chosen)
    passages = last.state.graph.passages
    assert list(passages) == [("a", "b", 0), ("a", "b", 1), ("b", "a", 0), ("b", "a", 1)]
    for (_, _, number), passage in passages.items():
        door = last.state.metric.doorways["a", "b", number].region
        assert door.distance(shapely.Point(passage.point)) < 0.06
    *_, first = drive(drawn(TWO_DOORS), walk, MappingOptions(edges=Edges.ADJACENT))
    assert list(first.state.graph.passages) == [("a", "b", 0), ("b", "a", 0)]
    assert first.state.graph.passages["a", "b", 0] == passages["a", "b", 0]


def pillared(gaps: str) -> LabelledRuns:
    """Return beams 0.05 rad apart that go from `a` through a door to `b`, or meet a pillar, `#`."""
    through, pillar = [("a", 1.0), ("door", 1.5), ("b", 3.0)], [("a", 1.0)]
    beams = [pillar if gap == "#" else through for gap in gaps]
    return LabelledRuns(
        angle_min=0.0, angle_increment=0.05, range_max=4.0, beams=beams,
        kinds={"door": Kind.PASSAGE},
    )  # fmt: skip


def test_a_doorway_seen_in_parts_is_one_passage_in_the_end() -> None:
    chosen = MappingOptions(edges=Edges.ADJACENT, passages=Passages.ALL)
    parts = from_runs(Pose(0, 0), pillared("++#++"))
    whole = from_runs(Pose(0, 0), pillared("+++++"))
    first, second, third = run([parts, whole, parts], chosen)
    assert list(first.state.graph.passages) == [("a", "b", 0), ("a", "b", 1)]
    assert second.events == (PassageJoined("a", "b", 1, 0),)
    assert list(second.state.graph.passages) == [("a", "b", 0)]
    assert third.events == ()
    assert third.state.graph is second.state.graph
    check_run([first, second, third], chosen)


def test_a_passage_with_the_number_that_goes_takes_the_one_that_stays() -> None:
    """Seen from `a` the one part of a doorway, from `b` the other: then both are one."""
    chosen = MappingOptions(edges=Edges.ADJACENT, passages=Passages.ALL)
    there = from_runs(Pose(0, 0), pillared("++###"))
    beams = [[("b", 1.5), ("door", 2.0), ("a", 3.0)]] * 2
    back = LabelledRuns(
        angle_min=np.pi - 0.05, angle_increment=0.05, range_max=4.0, beams=beams,
        kinds={"door": Kind.PASSAGE},
    )  # fmt: skip
    again = from_runs(Pose(3.0, 0.4), back)
    whole = from_runs(Pose(0, 0), pillared("++++++++"))
    steps = list(run([there, again, whole], chosen))
    assert list(steps[1].state.graph.passages) == [("a", "b", 0), ("b", "a", 1)]
    assert steps[2].events == (PassageJoined("b", "a", 1, 0),)
    assert list(steps[2].state.graph.passages) == [("a", "b", 0), ("b", "a", 0)]
    moved = steps[2].state.graph.passages["b", "a", 0]
    assert (moved.seq, moved.moved, moved.point) == (
        2, 3, steps[1].state.graph.passages["b", "a", 1].point,
    )  # fmt: skip
    check_run(steps, chosen)


def test_two_offices_stay_two() -> None:
    walk: list[Point] = [(1.5, 4.5), (1.5, 1.5), (4.5, 1.5), (7.5, 1.6), (6.5, 4.5)]
    steps = drive(drawn(TWO_OFFICES), walk, EACH)
    assert [taken.here for taken in steps] == ["o", "h", "h", "h", "o"]
    assert [taken.state.here for taken in steps] == ["o", "h", "h", "h", "o-2"]
    assert list(steps[-1].state.graph.nodes) == ["o", "h", "o-2"]
    assert ("o-2", "h") not in steps[-1].state.graph.pairs
    *_, one = drive(drawn(TWO_OFFICES), walk, MappingOptions(edges=Edges.ADJACENT))
    assert list(one.state.graph.nodes) == ["o", "h"]


@pytest.mark.parametrize("edges", list(Edges))
def test_a_room_seen_through_two_doors_is_one_in_the_end(edges: Edges) -> None:
    world = drawn(ROUND_A_PILLAR)
    chosen = MappingOptions(edges=edges, passages=Passages.ALL, identity=Identity.INSTANCE)
    walk: list[Point] = [(1.5, 1.7), (9.5, 1.7), (5.5, 4.0)]
    first, second, third = drive(world, walk, chosen)
    assert list(second.state.graph.nodes) == ["h", "o", "o-2"]
    assert [key for key in second.state.graph.passages if key[0] == "h"] == [
        ("h", "o", 0), ("h", "o-2", 0),
    ]  # fmt: skip
    assert NodeMerged("o-2", "o") in third.events
    graph = third.state.graph
    assert list(graph.nodes) == ["h", "o"]
    assert {("h", "o", 0), ("h", "o", 1)} <= graph.passages.keys()
    assert list(third.state.metric.doorways) == [("h", "o", 0), ("h", "o", 1)]
    assert graph.passages["h", "o", 1].point == second.state.graph.passages["h", "o-2", 0].point
    check_same_graph(graph.at(2), second.state.graph)
    check_run([first, second, third], chosen)
    only = MappingOptions(edges=edges, identity=Identity.INSTANCE)
    *_, last = drive(world, walk, only)
    assert [key for key in last.state.graph.passages if key[0] == "h"] == [("h", "o", 0)]


def test_a_door_between_two_places_of_one_label_is_an_edge() -> None:
    beam = [("o", 1.0), ("door", 1.5), ("o", 3.0)]
    seen_ = LabelledRuns(
        angle_min=0.0, angle_increment=0.1, range_max=4.0, beams=[beam, beam],
        kinds={"door": Kind.PASSAGE},
    )  # fmt: skip
    for chosen in (SEEN, EACH):
        (taken,) = run([from_runs(Pose(0, 0), seen_)], chosen)
        assert list(taken.state.graph.passages) == [("o", "o-2", 0)]
        assert list(taken.state.metric.doorways) == [("o", "o-2", 0)]
