"""The topology graph: what is found, in which order, and that it stays."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest
from hypothesis import given
from shapely import Polygon, box

from semtopo.findings import extend
from semtopo.fusion import Extent
from semtopo.graph import Event, Node, NodeFound, Passage, PassageFound, TopologyGraph
from semtopo.mapper import explore
from semtopo.metric import MetricMap
from semtopo.placement import place
from semtopo.sensor_map import Link, SensorMap
from semtopo.types import Edges, MappingOptions, Point
from semtopo.zones import Zone
from tests import oracle
from tests.strategies import Scene, options, patient, scenes

BOXES = {"a": box(0, 0, 1, 1), "b": box(2, 0, 3, 1), "c": box(4, 0, 5, 1)}


def ground(*parts: Polygon) -> np.ndarray[tuple[int], np.dtype[np.object_]]:
    return np.array(parts, dtype=np.object_)


def seen(labels: str, *pairs: str, here: str = "a", position: Point = (0.5, 0.5)) -> SensorMap:
    """Return a sensor map of boxes in a row; `pairs` are links, like "ab"."""
    zones = tuple(Zone(label, Extent.of(BOXES[label])) for label in labels)
    ends = [(pair[0], pair[1]) for pair in pairs]
    links = tuple(Link(source, target, partial(ground, BOXES[target])) for source, target in ends)
    return SensorMap(position, zones, here, links)


def extended(
    graph: TopologyGraph, sensor_map: SensorMap, seq: int
) -> tuple[TopologyGraph, tuple[Event, ...]]:
    """Return the graph after a scan whose labels are zones."""
    placed = place(MetricMap(), sensor_map, MappingOptions(), seq)
    return extend(graph, placed, seq)


def test_the_first_scan_makes_nodes_and_passages() -> None:
    graph, events = extended(TopologyGraph(), seen("ab", "ab"), 3)
    assert dict(graph.nodes) == {"a": Node("a", "a", 3), "b": Node("b", "b", 3)}
    assert dict(graph.passages) == {("a", "b", 0): Passage("a", "b", (2.0, 0.5), 3)}
    assert events == (
        NodeFound("a", "a"), NodeFound("b", "b"), PassageFound("a", "b", (2.0, 0.5)),
    )  # fmt: skip


def test_events_stand_in_the_order_of_the_algorithm() -> None:
    _, events = extended(TopologyGraph(), seen("abc", "ba", "bc", here="b"), 1)
    assert events == (
        NodeFound("b", "b"),
        NodeFound("a", "a"), PassageFound("b", "a", (0.5, 0.5)),
        NodeFound("c", "c"), PassageFound("b", "c", (4.0, 0.5)),
    )  # fmt: skip


def test_a_passage_between_others_waits_for_both_nodes() -> None:
    _, events = extended(TopologyGraph(), seen("abc", "ab", "cb"), 1)
    names = [
        event.label if isinstance(event, NodeFound) else event.source + event.target
        for event in events
        if isinstance(event, NodeFound | PassageFound)
    ]
    assert names == ["a", "b", "ab", "c", "cb"]


def test_a_known_passage_stays_where_it_is() -> None:
    first, _ = extended(TopologyGraph(), seen("ab", "ab"), 1)
    again, events = extended(first, seen("ab", "ab", position=(9.0, 0.25)), 2)
    assert again is first
    assert events == ()
    assert first.passages["a", "b", 0] == Passage("a", "b", (2.0, 0.5), 1)


def test_both_directions_are_two_passages() -> None:
    first, _ = extended(TopologyGraph(), seen("ab", "ab"), 1)
    second, events = extended(first, seen("ab", "ba", here="b", position=(2.5, 0.5)), 2)
    assert list(second.passages) == [("a", "b", 0), ("b", "a", 0)]
    assert events == (PassageFound("b", "a", (1.0, 0.5)),)


def test_an_older_graph_stays_as_it_was() -> None:
    first, _ = extended(TopologyGraph(), seen("ab", "ab"), 1)
    extended(first, seen("abc", "ac"), 2)
    assert list(first.nodes) == ["a", "b"]
    assert list(first.passages) == [("a", "b", 0)]


def test_an_empty_scan_leaves_the_same_graph() -> None:
    graph = TopologyGraph()
    assert extended(graph, SensorMap((0, 0), (), None, ()), 1) == (graph, ())


def difference(old: TopologyGraph, new: TopologyGraph) -> tuple[set[Event], int]:
    """Return what a graph has more than an older one, as events, and how many."""
    nodes = [NodeFound(n.label, n.zone_id) for key, n in new.nodes.items() if key not in old.nodes]
    passages = [
        PassageFound(p.source, p.target, p.point)
        for key, p in new.passages.items()
        if key not in old.passages
    ]
    return {*nodes, *passages}, len(nodes) + len(passages)


@patient
@given(scene=scenes(), chosen=options)
def test_events_are_the_difference_of_graphs(scene: Scene, chosen: MappingOptions) -> None:
    before = TopologyGraph()
    for taken in explore(scene.world, scene.sensor, scene.walk, chosen):
        graph = taken.state.graph
        wanted, count = difference(before, graph)
        assert set(taken.events) == wanted
        assert len(taken.events) == count
        assert (graph is before) == (count == 0)
        before = graph


@patient
@given(scene=scenes(), chosen=options)
def test_passages_stay_and_have_two_ends(scene: Scene, chosen: MappingOptions) -> None:
    before = TopologyGraph()
    for number, taken in enumerate(explore(scene.world, scene.sensor, scene.walk, chosen), start=1):
        graph = taken.state.graph
        assert before.passages.items() <= graph.passages.items()
        assert before.nodes.items() <= graph.nodes.items()
        for key, passage in graph.passages.items():
            assert key == passage.key
            assert passage.source != passage.target
            assert {passage.source, passage.target} <= graph.nodes.keys()
            assert passage.seq == number or key in before.passages
        before = graph


@patient
@given(scene=scenes())
def test_adjacent_edges_are_ones_that_a_beam_crossed(scene: Scene) -> None:
    chosen = MappingOptions(edges=Edges.ADJACENT)
    crossed: set[oracle.Crossing] = set()
    steps = explore(scene.world, scene.sensor, scene.walk, chosen)
    for position, taken in zip(scene.walk, steps, strict=True):
        crossed |= oracle.crossings(oracle.analyse(scene.world, scene.sensor, position))
        assert set(taken.state.graph.pairs) <= crossed


@pytest.mark.parametrize("name", ["nodes", "passages"])
def test_graphs_cannot_be_changed_from_outside(name: str) -> None:
    with pytest.raises(TypeError):
        getattr(TopologyGraph(), name)["a"] = None


def test_graphs_from_steps_cannot_be_changed_either() -> None:
    graph, _ = extended(TopologyGraph(), seen("ab", "ab"), 1)
    for name in ("nodes", "passages"):
        with pytest.raises(TypeError):
            getattr(graph, name)["a"] = None


@patient
@given(scene=scenes(), chosen=options)
def test_the_graph_at_an_earlier_step_is_the_one_of_that_step(
    scene: Scene, chosen: MappingOptions
) -> None:
    graphs = [taken.state.graph for taken in explore(scene.world, scene.sensor, scene.walk, chosen)]
    for number, graph in enumerate([TopologyGraph(), *graphs]):
        earlier = graphs[-1].at(number)
        assert list(earlier.nodes.items()) == list(graph.nodes.items())
        assert list(earlier.passages.items()) == list(graph.passages.items())
