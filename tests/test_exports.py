"""Exports are read by the programs that they are for, or by their libraries, and say the same."""

from __future__ import annotations

import io
import json
import math
import sys
from dataclasses import replace
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any

import networkx as nx
import pydot
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.geometry import shape

from semtopo.documents import LABEL_LENGTH_MAX
from semtopo.errors import NotExportableError
from semtopo.exports import EXPORTS, Format
from semtopo.exports import nav2 as nav2_room
from semtopo.exports.attributes import attributed_graph
from semtopo.exports.chart import Chart
from semtopo.exports.geojson import border_features
from semtopo.formats import read_path, read_world
from semtopo.graph import Node, Passage, TopologyGraph
from semtopo.mapper import MapState, explore
from semtopo.metric import MetricMap
from semtopo.sensor import Sensor
from tests.strategies import Scene, scenes
from tests.test_cli import PATH, WORLD, semtopo
from tests.test_render import mapped

pytestmark = pytest.mark.filterwarnings("ignore:.*deprecated - use:DeprecationWarning")
"""pydot calls pyparsing by former names."""

HOSTILE = ["<&>\"'", "back\\slash\\", 'quo"te', "a \u2192 b; c", "K\u00fcche", "\u4f1a\u8b70\u5ba4",
           "&amp;", "\\N", "{x|y}", "digraph", "1e5", "true", "a  b", "-->"]  # fmt: skip


@cache
def paper(seq: int = 81) -> MapState:
    path = [pose.position for pose in read_path(PATH.read_bytes())]
    *_, last = explore(read_world(WORLD.read_bytes()), Sensor(72), path[:seq])
    return last.state


def hostile() -> MapState:
    """Give a map with labels of all sorts, and parallel edges between all neighbours."""
    zones = {it: mapped(it, shapely.box(i, 0, i + 0.9, 1)) for i, it in enumerate(HOSTILE)}
    nodes = {it: Node(it, it, 1) for it in HOSTILE}
    edges = [Passage(a, b, (i + 0.1, 0.2), i + 1, number)
             for i, (a, b) in enumerate(pairwise(HOSTILE))
             for number in (0, 1)]  # fmt: skip
    return MapState(20, MetricMap(zones), TopologyGraph(nodes, {it.key: it for it in edges}))


def written(form: Format, state: MapState, radius: float = 0.0) -> bytes:
    body = EXPORTS[form].write(Chart(state, border_features(state), radius))
    assert body == EXPORTS[form].write(Chart(state, border_features(state), radius))
    return body


class TestGraphs:
    @pytest.mark.parametrize(
        "state", [MapState(), paper(), hostile()], ids=["none", "paper", "odd"]
    )
    def test_networkx_reads_graphml_back(self, state: MapState) -> None:
        body = io.BytesIO(written(Format.GRAPHML, state))
        back = nx.read_graphml(body, node_type=str, edge_key_type=int, force_multigraph=True)
        assert back.is_directed()
        assert isinstance(back, nx.MultiDiGraph)
        self.assert_same(back, attributed_graph(Chart(state, ()).state))

    @pytest.mark.parametrize(
        "state", [MapState(), paper(), hostile()], ids=["none", "paper", "odd"]
    )
    def test_pydot_reads_dot_back(self, state: MapState) -> None:
        read = read_dot(written(Format.DOT, state))
        assert read.get_type() == "digraph"
        known = attributed_graph(Chart(state, ()).state)
        nodes = {it.get_name(): told(it) for it in read.get_nodes() if it.get_name() != "\\n"}
        ids = {name: node["zone_id"] for name, node in nodes.items()}
        back: nx.MultiDiGraph[str] = nx.MultiDiGraph()
        for node in nodes.values():
            assert node["label"] == node["zone_id"].replace("&", "&amp;")
            rest = {key: float(node[key]) for key in ("area", "x", "y", "since", "seq")}
            back.add_node(node["zone_id"], label=node["class"], **rest)
        for edge in read.get_edges():
            numbers = {key: float(value) for key, value in told(edge).items()}
            source, target = ids[edge.get_source()], ids[edge.get_destination()]
            back.add_edge(source, target, int(numbers["number"]), **numbers)
        self.assert_same(back, known)

    def assert_same(self, back: nx.MultiDiGraph[str], known: nx.MultiDiGraph[str]) -> None:
        assert list(back.nodes(data=True)) == list(known.nodes(data=True))
        assert dict(back.edges) == dict(known.edges)

    @settings(max_examples=50)
    @given(label=st.text(st.characters(categories=["L", "M", "N", "P", "S"]), min_size=1,
                         max_size=LABEL_LENGTH_MAX))  # fmt: skip
    def test_any_label_survives(self, label: str) -> None:
        state = MapState(1, MetricMap({label: mapped(label, shapely.box(0, 0, 1, 1))}),
                         TopologyGraph({label: Node(label, label, 1)}))  # fmt: skip
        assert list(nx.read_graphml(io.BytesIO(written(Format.GRAPHML, state)))) == [label]
        read = read_dot(written(Format.DOT, state))
        assert told(read.get_node("z0")[0])["zone_id"] == label
        assert (
            json.loads(written(Format.SPARK_DSG, state))["nodes"][0]["attributes"]["name"] == label
        )


def read_dot(body: bytes) -> Any:  # noqa: ANN401 -- pydot has few types
    (read,) = pydot.graph_from_dot_data(body.decode()) or []
    return read


def told(item: Any) -> dict[str, str]:  # noqa: ANN401 -- pydot has no types for them
    """Give the attributes of a node or an edge as they were before they were put in quotes."""
    return {
        key: value[1:-1].replace('\\"', '"').replace("\\\\", "\\")
        for key, value in item.get_attributes().items()
    }


def test_geojson_has_all_layers() -> None:
    state = paper()
    collection = json.loads(written(Format.GEOJSON, state))
    layers: dict[str, list[Any]] = {}
    for feature in collection["features"]:
        layers.setdefault(feature["properties"]["layer"], []).append(feature)
        assert shape(feature["geometry"]).is_valid
    assert {it["id"] for it in layers["zone"]} == set(state.metric.zones)
    doors = {tuple(it["properties"]["ends"]) for it in layers["doorway"]}
    assert doors == {(room, "corridor") for room in "ABCD"}
    passages = [it["properties"] for it in layers["passage"]]
    assert [(it["source"], it["target"], it["number"]) for it in passages] == [
        *state.graph.passages
    ]
    lines = [shape(it["geometry"]) for it in layers["frontier"]]
    free = [it for it in border_features(state) if it["properties"]["occupancy"] == "free"]
    assert len(lines) == len(free) > 10
    assert all(any(zone.region.boundary.dwithin(line, 1e-9) for zone in state.metric.zones.values())
               for line in lines)  # fmt: skip


class TestNav2:
    """What the route server checks when it reads a graph, and what a robot needs of it."""

    def read(self, state: MapState, radius: float = 0.0) -> tuple[nx.DiGraph[int], Any]:
        """Read a graph as `nav2_route` does: points are nodes, lines are edges."""
        document = json.loads(written(Format.NAV2, state, radius))
        graph: nx.DiGraph[int] = nx.DiGraph()
        features = document["features"]
        nodes = [it for it in features if it["geometry"]["type"] == "Point"]
        edges = [it for it in features if it["geometry"]["type"] == "LineString"]
        assert nodes
        assert edges
        assert [*nodes, *edges] == features
        assert [it["properties"]["id"] for it in features] == list(range(len(features)))
        for node in nodes:
            assert node["properties"]["frame"] == "map"
            point = tuple(node["geometry"]["coordinates"])
            graph.add_node(node["properties"]["id"], point=point, **node["properties"]["metadata"])
        for edge in edges:
            about = edge["properties"]
            assert {about["startid"], about["endid"]} <= set(graph)
            assert isinstance(about["cost"], float)
            assert about["overridable"] is True
            ends = [list(graph.nodes[about[end]]["point"]) for end in ("startid", "endid")]
            assert edge["geometry"]["coordinates"] == ends
            assert not graph.has_edge(about["startid"], about["endid"])
            graph.add_edge(about["startid"], about["endid"], cost=about["cost"])
        assert all(is_metadata(it["properties"]["metadata"]) for it in features)
        return graph, document

    @pytest.mark.parametrize("radius", [0.0, 0.3])
    def test_a_robot_that_follows_it_stays_in_free_space(self, radius: float) -> None:
        state = paper()
        graph, _ = self.read(state, radius)
        known = [it.region for it in state.metric.zones.values()]
        known += [it.region for it in state.metric.doorways.values()]
        free = shapely.union_all(known)
        for one, other, data in graph.edges(data=True):
            line = shapely.LineString([graph.nodes[it]["point"] for it in (one, other)])
            assert free.covers(line)
            assert free.boundary.distance(line) > radius - 1e-3
            assert data["cost"] == pytest.approx(line.length)

    def test_its_reachability_is_that_of_the_passages(self) -> None:
        graph, document = self.read(paper())
        assert document["left_out"] == []
        places = {graph.nodes[it]["zone"]: it for it in graph if graph.nodes[it]["kind"] == "place"}
        assert set(places) == {"corridor", "A", "B", "C", "D"}
        for one, other in ((a, b) for a in places.values() for b in places.values()):
            assert nx.has_path(graph, one, other)

    def test_one_does_not_go_where_no_passage_leads(self) -> None:
        """At step 5 the way back from A is not known, and at step 4 not even the room."""
        graph, _ = self.read(paper(5))
        places = {graph.nodes[it]["zone"]: it for it in graph if graph.nodes[it]["kind"] == "place"}
        assert nx.has_path(graph, places["corridor"], places["A"])
        assert not nx.has_path(graph, places["A"], places["corridor"])

    def test_ways_are_hardly_longer_than_the_shortest(self) -> None:
        graph, _ = self.read(paper())
        doors = [it for it in graph if graph.nodes[it]["kind"] == "doorway"]
        assert len(doors) == 4
        for one, other in ((a, b) for a in doors for b in doors if a < b):
            length = nx.dijkstra_path_length(graph, one, other, weight="cost")
            assert length < 25, "half the ring of the corridor is some 20 m long"
            assert length >= math.dist(graph.nodes[one]["point"], graph.nodes[other]["point"])

    def test_a_passage_without_a_way_is_named(self) -> None:
        graph, document = self.read(paper(29))
        assert document["left_out"] == [["C", "corridor", 0]]
        assert {graph.nodes[it].get("zone") for it in graph} == {None, "corridor", "A"}

    def test_a_robot_too_wide_has_nowhere_to_go(self) -> None:
        with pytest.raises(NotExportableError):
            written(Format.NAV2, paper(), 5.0)

    def test_what_the_server_cannot_hold_is_refused(self, monkeypatch: pytest.MonkeyPatch) -> None:
        state = paper()
        count = len(json.loads(written(Format.NAV2, state))["features"])
        monkeypatch.setattr(nav2_room, "IDS_MAX", count)
        written(Format.NAV2, state)
        monkeypatch.setattr(nav2_room, "IDS_MAX", count - 1)
        with pytest.raises(NotExportableError):
            written(Format.NAV2, state)
        assert nav2_room.PASSAGES_MAX < 65_535

    @pytest.mark.parametrize("state", [MapState(), paper(1), hostile()], ids=["none", "one", "odd"])
    def test_without_ways_there_is_no_graph(self, state: MapState) -> None:
        with pytest.raises(NotExportableError):
            written(Format.NAV2, state)

    def test_too_much_work_is_refused(self) -> None:
        chart = Chart(paper(), (), work_max=100)
        with pytest.raises(NotExportableError):
            EXPORTS[Format.NAV2].write(chart)
        assert EXPORTS[Format.NAV2].write(replace(chart, work_max=10**6))

    @settings(max_examples=10)
    @given(scene=scenes(), radius=st.sampled_from([0.0, 0.05]))
    def test_any_map_is_written_or_refused(self, scene: Scene, radius: float) -> None:
        *_, last = explore(scene.world, scene.sensor, scene.walk)
        try:
            graph, document = self.read(last.state, radius)
        except NotExportableError:
            return
        known = [it.region for it in last.state.metric.zones.values()]
        known += [it.region for it in last.state.metric.doorways.values()]
        free = shapely.union_all(known).buffer(1e-6)
        assert all(
            free.covers(shapely.LineString([graph.nodes[it]["point"] for it in edge]))
            for edge in graph.edges
        )
        assert {tuple(it) for it in document["left_out"]} <= set(last.state.graph.passages)


def is_metadata(value: object) -> bool:
    """Say whether the route server can hold a value: no null, and no list within a list."""
    match value:
        case dict():
            return all(map(is_metadata, value.values()))
        case list():
            return all(isinstance(it, str | int | float) for it in value)
        case _:
            return isinstance(value, str | int | float)


@pytest.mark.skipif(sys.version_info >= (3, 15), reason="spark-dsg has no wheel for it yet")
class TestSparkDsg:
    def loaded(self, state: MapState, folder: Path) -> Any:  # noqa: ANN401 -- has no types
        spark_dsg = pytest.importorskip("spark_dsg")
        file = folder / "map.json"
        file.write_bytes(written(Format.SPARK_DSG, state))
        return spark_dsg.DynamicSceneGraph.load(str(file))

    @pytest.mark.parametrize("state", [paper(), hostile()], ids=["paper", "odd"])
    def test_rooms_are_the_zones(self, state: MapState, tmp_path: Path) -> None:
        graph = self.loaded(state, tmp_path)
        rooms = list(graph.get_layer("ROOMS").nodes)
        assert len(rooms) == graph.num_nodes() == len(state.metric.zones)
        labels = graph.get_labelspace(4, 0)
        for room, zone in zip(rooms, state.metric.zones.values(), strict=True):
            about = room.attributes
            assert type(about).__name__ == "RoomNodeAttributes"
            assert about.name == zone.zone_id
            assert labels.get_category(about.semantic_label) == zone.label
            assert zone.region.covers(shapely.Point(about.position[:2]))
            region = shape(about.metadata.get()["region"])
            assert region.equals(zone.region)
            assert about.bounding_box.is_valid()
            assert about.bounding_box.world_P_center[:2] == pytest.approx(
                [sum(zone.region.bounds[axis::2]) / 2 for axis in (0, 1)], rel=1e-5
            )

    @pytest.mark.parametrize("state", [paper(), paper(29), hostile()], ids=["all", "29", "odd"])
    def test_edges_keep_their_directions_in_metadata(self, state: MapState, tmp_path: Path) -> None:
        graph = self.loaded(state, tmp_path)
        names = {node.id.value: node.attributes.name for node in graph.get_layer("ROOMS").nodes}
        found = set()
        for edge in graph.get_layer("ROOMS").edges:
            ends = {names[edge.source], names[edge.target]}
            assert edge.info.weight > 0
            for passage in edge.info.metadata.get()["passages"]:
                assert {passage["source"], passage["target"]} == ends
                found.add((passage["source"], passage["target"], passage["number"]))
        assert found == set(state.graph.passages)

    def test_an_empty_map_is_loaded_too(self, tmp_path: Path) -> None:
        assert self.loaded(MapState(), tmp_path).num_nodes() == 0


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Give the folder of the paper's drive."""
    out = tmp_path_factory.mktemp("exports")
    semtopo("map", WORLD, PATH, "--out", out)
    return out


class TestCommand:
    @pytest.mark.parametrize("form", Format)
    def test_writes_what_the_library_does(self, folder: Path, form: Format, tmp_path: Path) -> None:
        file = tmp_path / "map"
        done = semtopo("export", folder, form, file, "--radius", "0.2")
        assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
        assert file.read_bytes() == written(form, paper(), 0.2)

    def test_writes_to_standard_output(self, folder: Path) -> None:
        assert semtopo("export", folder, "dot").stdout == written(Format.DOT, paper()).decode()

    @pytest.mark.parametrize(
        ("name", "content", "line"),
        [
            ("doorways.geojson", "{}", "doorways.geojson: this is no collection of features"),
            ("doorways.geojson", '{"features": [1]}', "this is no collection of features"),
            ("doorways.geojson", '{"features": [{}]}', "these are not the doorways of a map"),
            ("borders.geojson", '{"features": 1}', "this is no collection of features"),
            ("borders.geojson", '{"features": [{}]}', "these are not the borders of a map"),
            ("borders.geojson", "no", "this is no collection of features"),
            ("graph.json", "[]", "these are not the zones and the graph of a map"),
        ],
    )
    def test_refuses_a_folder_that_is_none(
        self, folder: Path, tmp_path: Path, name: str, content: str, line: str
    ) -> None:
        for file in folder.iterdir():
            (tmp_path / file.name).write_bytes(file.read_bytes())
        (tmp_path / name).write_text(content)
        done = semtopo("export", tmp_path, "geojson")
        assert done.returncode == 2
        assert line in done.stderr
        assert done.stderr.count("\n") == 1

    @pytest.mark.parametrize(
        "options", [["gml"], ["nav2", "--radius", "-1"], ["nav2", "--radius", "9"]]
    )
    def test_refuses_what_cannot_be(self, folder: Path, options: list[str]) -> None:
        done = semtopo("export", folder, *options)
        assert (done.returncode, done.stdout) == (2, "")
        assert done.stderr.startswith("semtopo: ")
        assert done.stderr.count("\n") == 1
