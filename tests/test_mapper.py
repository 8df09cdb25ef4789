"""Whole runs: against the oracle, and what holds after every step."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator

import pytest
import shapely
from hypothesis import given

from semtopo.graph import NodeFound, PassageFound
from semtopo.mapper import MapState, Stage, Step, explore, run, scan_world, step
from semtopo.runs import LabelledRuns, from_runs
from semtopo.sensor import Sensor
from semtopo.types import Kind, MappingOptions, Point, Pose
from tests import oracle
from tests.plans import TWO_ROOMS, drawn
from tests.strategies import Scene, labelled_runs, many, offsets, options, patient, poses, scenes

SAME = 1e-7  # m and m^2: rounding of a few unions


def check_step(wanted: oracle.Step, found: Step, position: Point) -> None:
    """Compare a step with the oracle's: here, events and regions."""
    assert found.here == wanted.here
    named = [
        event.label if isinstance(event, NodeFound) else (event.source, event.target)
        for event in found.events
        if isinstance(event, NodeFound | PassageFound)
    ]
    assert named == wanted.events
    assert len(named) == len(found.events)
    zones = found.state.metric.zones
    assert zones.keys() == wanted.state.zones.keys()
    for label, region in wanted.state.zones.items():
        assert zones[label].region.symmetric_difference(region).area < SAME
    for event in found.events:
        if isinstance(event, PassageFound):
            edge = wanted.state.edges[event.source, event.target]
            assert math.dist(event.point, position) == pytest.approx(edge.distance, abs=SAME)
            assert wanted.state.zones[event.target].distance(shapely.Point(event.point)) < SAME


@patient
@given(scene=scenes(), chosen=options)
def test_a_run_equals_the_oracles(scene: Scene, chosen: MappingOptions) -> None:
    found = explore(scene.world, scene.sensor, scene.walk, chosen)
    scans = [oracle.analyse(scene.world, scene.sensor, position) for position in scene.walk]
    for position, one, two in zip(scene.walk, oracle.run(scans, chosen), found, strict=True):
        check_step(one, two, position)


@patient
@given(scene=scenes(), chosen=options)
def test_labels_of_the_map_are_the_nodes_of_the_graph(scene: Scene, chosen: MappingOptions) -> None:
    for number, taken in enumerate(explore(scene.world, scene.sensor, scene.walk, chosen), start=1):
        state = taken.state
        assert state.seq == number
        assert list(state.metric.zones) == list(state.graph.nodes)
        assert taken.here is None or taken.here in state.graph.nodes


@patient
@given(seen=labelled_runs(), first=poses, second=poses, chosen=options)
def test_runs_of_a_real_robot_keep_the_same_promises(
    seen: LabelledRuns, first: Pose, second: Pose, chosen: MappingOptions
) -> None:
    before = MapState()
    for taken in run([from_runs(pose, seen) for pose in (first, second, first)], chosen):
        metric, graph = taken.state.metric, taken.state.graph
        assert list(metric.zones) == list(graph.nodes)
        assert before.graph.passages.items() <= graph.passages.items()
        for label, zone in metric.zones.items():
            assert zone.region.is_valid
            if label in before.metric.zones:
                old = before.metric.zones[label].region
                assert old.difference(zone.region).area < 1e-9
        last, before = before, taken.state
    assert before.graph is last.graph
    assert before.metric.changed_since(last.metric) == []


@patient
@given(scene=scenes(), chosen=options, offset=offsets)
def test_moving_world_and_robot_moves_the_map(
    scene: Scene, chosen: MappingOptions, offset: Point
) -> None:
    moved = scene.moved(*offset)
    here = explore(scene.world, scene.sensor, scene.walk, chosen)
    there = explore(moved.world, scene.sensor, moved.walk, chosen)
    for one, two in zip(here, there, strict=True):
        assert one.here == two.here
        assert list(one.state.graph.passages) == list(two.state.graph.passages)
        for label, zone in one.state.metric.zones.items():
            other = two.state.metric.zones[label].region
            assert zone.region.area == pytest.approx(other.area, abs=1e-6)


@patient
@given(scene=scenes(), chosen=options)
def test_the_same_run_twice_gives_the_same(scene: Scene, chosen: MappingOptions) -> None:
    one, two = (explore(scene.world, scene.sensor, scene.walk, chosen) for _ in range(2))
    for first, second in zip(one, two, strict=True):
        assert (first.here, first.events) == (second.here, second.events)
        for label, zone in first.state.metric.zones.items():
            assert zone.region.wkb == second.state.metric.zones[label].region.wkb


def test_scenes_are_not_vacuous() -> None:
    """Of the drawn scenes, at least nine in ten show what the properties speak of."""
    counts: Counter[str] = Counter()

    @many
    @given(scene=scenes())
    def count(scene: Scene) -> None:
        scan = scan_world(scene.world, scene.sensor, scene.walk[0])
        taken = step(MapState(), scan, MappingOptions())
        rows = oracle.measure(scene.world, scene.sensor, scene.walk[0])
        kinds = {sample.kind for row in rows for sample in row}
        counts["scenes"] += 1
        counts["zones"] += len(taken.state.metric.zones) >= 2
        counts["edges"] += len(taken.state.graph.passages) >= 1
        counts["passages"] += Kind.PASSAGE in kinds
        counts["obstacles"] += Kind.OBSTACLE in kinds
        counts["entered"] += len(set(scan.intervals.source.tolist())) >= 2

    count()
    scenes_drawn = counts.pop("scenes")
    assert scenes_drawn >= 100
    assert {name: n for name, n in counts.items() if n < 0.9 * scenes_drawn} == {}
    assert len(counts) == 5


def test_stages_end_in_the_order_of_table_1() -> None:
    ended: list[Stage] = []
    scan = scan_world(drawn(TWO_ROOMS), Sensor(), (2.0, 2.0), ended.append)
    step(MapState(), scan, MappingOptions(), ended.append)
    assert ended == list(Stage)
    assert [str(stage) for stage in Stage] == [
        "measurement", "analysis", "extraction", "map_update", "graph_update",
    ]  # fmt: skip


def test_a_state_begins_empty() -> None:
    state = MapState()
    assert (state.seq, len(state.metric.zones), len(state.graph.nodes)) == (0, 0, 0)
    assert len(state.graph.passages) == 0


def test_no_scans_are_no_steps() -> None:
    assert list(run([])) == []


def test_steps_are_taken_one_at_a_time() -> None:
    """A run is lazy: scans may come in as the robot drives."""
    taken: list[Point] = []

    def positions() -> Iterator[Point]:
        for position in ((2.0, 2.0), (2.0, 2.5)):
            taken.append(position)
            yield position

    steps = explore(drawn(TWO_ROOMS), Sensor(), positions())
    next(steps)
    assert taken == [(2.0, 2.0)]


def test_states_branch() -> None:
    """States are values: two futures of one state know nothing of each other."""
    world, sensor, options_ = drawn(TWO_ROOMS), Sensor(range=4.0), MappingOptions()
    common = step(MapState(), scan_world(world, sensor, (2.0, 2.0)), options_).state
    stay = step(common, scan_world(world, sensor, (2.0, 2.5)), options_).state
    leave = step(common, scan_world(world, sensor, (5.0, 2.0)), options_).state
    assert stay.seq == leave.seq == 2
    assert ("b", "a") in leave.graph.pairs
    assert ("b", "a") not in stay.graph.pairs
    assert ("b", "a") not in common.graph.pairs
