"""Pictures are valid SVG, the same each time, and say what is on the map."""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.geometry.base import BaseGeometry

from semtopo.errors import InvalidOptionError
from semtopo.formats import read_path, read_world
from semtopo.geometry import Region
from semtopo.graph import Node, Passage, TopologyGraph
from semtopo.mapper import MapState, explore
from semtopo.metric import MappedZone, MetricMap
from semtopo.render import render
from semtopo.render.drawing import (
    ALL_LAYERS,
    DEFAULT_LAYERS,
    SIDE_MAX,
    SIDE_MIN,
    TRAIL_MAX,
    Drawing,
    DrawnRoute,
    Layer,
    read_layers,
    thinned_trail,
    trail_stride,
)
from semtopo.render.frame import frame_around, round_length
from semtopo.render.labels import Label, NamedRegion, place_labels
from semtopo.render.layout import Nodes, lay_out
from semtopo.render.palette import OCCUPANCY, ROUTE, shade
from semtopo.sensor import Sensor
from semtopo.types import Occupancy, Point
from tests.extents import all_around

EXAMPLE = Path(__file__).parents[1] / "examples" / "paper"
NO_PATH = shapely.Point()


def mapped(label: str, region: Region) -> MappedZone:
    return MappedZone(label, label, all_around(region, Occupancy.OBSTACLE), since=1, seq=1)


def state_of(zones: Mapping[str, Region], *edges: tuple[str, str]) -> MapState:
    metric = MetricMap({label: mapped(label, region) for label, region in zones.items()})
    nodes = {label: Node(label, label, 1) for label in zones}
    passages = {(a, b, 0): Passage(a, b, (0.0, 0.0), 1) for a, b in edges}
    return MapState(1, metric, TopologyGraph(nodes, passages))


def texts(picture: str) -> list[str]:
    """Give all text elements of a picture."""
    root = ET.fromstring(picture)  # noqa: S314 -- our own picture
    return [element.text or "" for element in root.iter("{http://www.w3.org/2000/svg}text")]


def titles(picture: str) -> list[str]:
    root = ET.fromstring(picture)  # noqa: S314 -- our own picture
    return [element.text or "" for element in root.iter("{http://www.w3.org/2000/svg}title")]


@pytest.fixture(scope="module")
def path() -> list[Point]:
    return [pose.position for pose in read_path((EXAMPLE / "path.csv").read_bytes())]


@pytest.fixture(scope="module")
def paper(path: list[Point]) -> MapState:
    *_, last = explore(read_world((EXAMPLE / "world.json").read_bytes()), Sensor(36), path)
    return last.state


class TestPaper:
    def test_names_every_zone_on_both_sides(self, paper: MapState, path: list[Point]) -> None:
        written = texts(render(paper, Drawing(trail=path)))
        assert [written.count(label) for label in paper.graph.nodes] == [2, 2, 2, 2, 2]
        assert "81 steps, 5 zones, 8 passages" in written

    def test_shows_every_passage_on_both_sides(self, paper: MapState) -> None:
        shown = titles(render(paper))
        for source, target in paper.graph.pairs:
            arrow = f"{source} \u2192 {target} at"
            assert len([title for title in shown if title.startswith(arrow)]) == 2

    def test_shows_border_points_by_occupancy(self, paper: MapState) -> None:
        picture = render(paper)
        for meaning in (Occupancy.OBSTACLE, Occupancy.PASSAGE, Occupancy.FREE):
            dots = re.search(rf'<path d="([^"]*)" stroke="{OCCUPANCY[meaning]}"', picture)
            assert dots is not None
            assert dots[1].count("h0") > 5

    def test_is_the_same_each_time(self, paper: MapState, path: list[Point]) -> None:
        assert render(paper, Drawing(trail=path)) == render(paper, Drawing(trail=path))

    def test_is_small(self, paper: MapState, path: list[Point]) -> None:
        assert len(render(paper, Drawing(trail=path))) < 100_000


def test_empty_map_says_so() -> None:
    picture = render(MapState())
    assert "no zones yet" in texts(picture)
    assert "no zones yet" in texts(render(MapState(seq=2), Drawing(trail=[(1, 2), (1, 2)])))
    assert "nan" not in picture


@pytest.mark.parametrize("label", ["<&>\"'", "K\u00fcche", "\u4f1a\u8b70\u5ba4", "a" * 100])
def test_any_label_is_written(label: str) -> None:
    picture = render(state_of({label: shapely.box(0, 0, 1, 1), "b": shapely.box(2, 0, 3, 1)}))
    assert any(title == label for title in titles(picture))


@settings(max_examples=30)
@given(st.lists(st.text(min_size=1, max_size=30), min_size=1, max_size=4, unique=True))
def test_no_label_breaks_the_picture(labels: list[str]) -> None:
    zones = {label: shapely.box(i, 0, i + 0.9, 1) for i, label in enumerate(labels)}
    edges = itertools.permutations(labels, 2)
    ET.fromstring(render(state_of(zones, *edges)).encode())  # noqa: S314 -- our own picture


@pytest.mark.parametrize(
    "zones",
    [
        {"big": shapely.box(0, 0, 1e6, 10), "tiny": shapely.box(5, 5, 5.0001, 5.0001)},
        {"a": shapely.box(0, 0, 1, 1), "b": shapely.box(0, 0, 1, 1), "c": shapely.box(0, 0, 1, 1)},
        {"parts": shapely.MultiPolygon([shapely.box(0, 0, 1, 1), shapely.box(5, 5, 6, 6)])},
        {"far": shapely.box(-1e6, 1e6 - 1, 1 - 1e6, 1e6)},
        {"thin": shapely.box(0, 0, 1e-4, 10)},
    ],
    ids=["sizes", "one upon the other", "two parts", "far away", "thin"],
)
def test_odd_maps_are_drawn(zones: dict[str, Region]) -> None:
    picture = render(state_of(zones, *itertools.permutations(zones, 2)), Drawing(trail=[(0, 0)]))
    assert not re.search(r"\b(nan|inf)\b", picture)
    assert all(texts(picture).count(label) == 2 for label in zones)


PANEL = (400.0, 400.0)


def labels(
    zones: Mapping[str, Region], lines: BaseGeometry = NO_PATH, route: BaseGeometry = NO_PATH
) -> list[Label]:
    return place_labels([NamedRegion(*zone) for zone in zones.items()], lines, route, PANEL)


class TestLabels:
    def test_lies_in_a_ring(self) -> None:
        ring = shapely.box(0, 0, 300, 300).difference(shapely.box(60, 60, 240, 240))
        assert isinstance(ring, shapely.Polygon)
        (label,) = labels({"corridor": ring})
        assert ring.contains(label.box)

    def test_keeps_off_the_path(self) -> None:
        room, path = shapely.box(0, 0, 200, 200), shapely.LineString([(0, 100), (200, 100)])
        (label,) = labels({"room": room}, path)
        assert room.contains(label.box)
        assert label.box.disjoint(path)

    def test_keeps_off_the_route_where_the_trail_is_everywhere(self) -> None:
        room = shapely.box(0, 0, 200, 200)
        trail = shapely.MultiLineString([[(0, y), (200, y)] for y in range(0, 201, 5)])
        begin = shapely.Point(100, 100).buffer(7)
        (crossed,) = labels({"room": room}, trail)
        (label,) = labels({"room": room}, trail, begin)
        assert crossed.box.intersects(begin)
        assert label.box.disjoint(begin)
        assert label.size == crossed.size

    def test_crosses_the_route_where_there_is_no_other_place(self) -> None:
        room = shapely.box(0, 0, 40, 20)
        (label,) = labels({"room": room}, NO_PATH, room)
        assert room.contains(label.box)

    def test_is_shortened_and_beside_its_zone_where_there_is_no_room(self) -> None:
        tiny = shapely.box(200, 200, 220, 220)
        (label,) = labels({"n" * 100: tiny})
        assert (label.words, label.size) == ("n" * 23 + "\u2026", 9.0)
        assert label.box.intersects(tiny)

    def test_stays_on_the_panel(self) -> None:
        corner = shapely.box(0, 0, 8, 8)
        (label,) = labels({"a long name": corner})
        assert shapely.box(0, 0, *PANEL).contains(label.box)
        assert label.box.dwithin(corner, 20)

    def test_is_left_out_where_it_would_cover_others(self) -> None:
        crowd = {f"a crowded room {i}{j}": shapely.box(9 * i, 9 * j, 9 * i + 8, 9 * j + 8)
                 for i in range(10) for j in range(10)}  # fmt: skip
        placed = labels(crowd)
        assert 5 < len(placed) < 80
        boxes = [label.box for label in placed]
        assert all(a.disjoint(b) for a, b in itertools.combinations(boxes, 2))

    def test_do_not_sit_on_each_other(self) -> None:
        zones = {f"room {i}": shapely.box(30 * i, 0, 30 * i + 28, 40) for i in range(12)}
        placed = labels(zones)
        assert all(a.box.disjoint(b.box) for a, b in itertools.combinations(placed, 2))
        assert len(placed) > 6

    def test_have_the_size_that_fits(self) -> None:
        sizes = [
            labels({"corridor": shapely.box(0, 0, width, 60)})[0].size for width in (300, 60, 52)
        ]
        assert sizes == sorted(sizes, reverse=True)
        assert len(set(sizes)) == 3
        assert labels({}) == []
        assert Label("a", (0, 0), 10).box.area > 0


class TestLayout:
    @pytest.mark.parametrize("count", [2, 5, 44])
    @pytest.mark.parametrize("spread", [0.0, 1.0], ids=["all in one place", "in a row"])
    def test_nodes_lie_apart_and_on_the_panel(self, count: int, spread: float) -> None:
        home = np.stack([300 + spread * np.arange(count), np.full(count, 300.0)], axis=-1)
        half = np.tile([30.0, 13.0], (count, 1))
        links = np.stack([np.zeros(count - 1, dtype=np.intp), np.arange(1, count)], axis=-1)
        middles = lay_out(Nodes(home, half, links), (800.0, 800.0))
        boxes = shapely.box(*(middles - half).T, *(middles + half).T)
        assert all(a.disjoint(b) for a, b in itertools.combinations(boxes, 2))
        assert shapely.contains(shapely.box(0, 0, 800, 800), boxes).all()

    def test_edges_keep_off_other_nodes(self) -> None:
        home = np.array([[100.0, 300.0], [300.0, 300.0], [500.0, 300.0]])
        half = np.tile([30.0, 13.0], (3, 1))
        middles = lay_out(Nodes(home, half, np.array([[0, 2]])), (600.0, 600.0))
        edge = shapely.LineString(middles[[0, 2]])
        assert edge.disjoint(shapely.box(*(middles[1] - half[1]), *(middles[1] + half[1])))


class TestFrame:
    def test_y_points_up_and_all_is_shown(self) -> None:
        frame = frame_around(np.array([[0.0, 0.0], [10.0, 5.0]]), (100, 100), (500, 400))
        (left, bottom), (right, top) = frame.pixel((0, 0)), frame.pixel((10, 5))
        assert 0 < left < right < frame.size[0]
        assert 0 < top < bottom < frame.size[1]
        assert math.isclose((right - left) / 10, (bottom - top) / 5)

    @pytest.mark.parametrize("length", [0.001, 0.3, 1.0, 1.1, 4.9, 5.1, 9.9, 12345.0])
    def test_round_length(self, length: float) -> None:
        rounded = round_length(length)
        assert length <= rounded <= 2.5 * length
        assert f"{rounded:e}"[0] in "125"

    def test_ticks_are_round_numbers_in_the_window(self) -> None:
        frame = frame_around(np.array([[-3.0, 0.0], [10.0, 5.0]]), (100, 100), (500, 400))
        assert frame.ticks(0) == [-2.0, 0.0, 2.0, 4.0, 6.0, 8.0, 10.0]


def test_zones_that_follow_each_other_differ_in_colour() -> None:
    shades = [shade(number) for number in range(40)]
    assert len({each.area for each in shades}) == 40
    assert len({each.line for each in shades[:8]}) == 8


def drawn_size(picture: str) -> tuple[float, float]:
    root = ET.fromstring(picture)  # noqa: S314 -- our own picture
    assert root.get("viewBox") == f"0 0 {root.get('width')} {root.get('height')}"
    return (float(root.get("width", "")), float(root.get("height", "")))


class TestSize:
    @pytest.mark.parametrize("size", [(390, 844), (1280, 720), (240, 240), (4096, 240)])
    def test_is_the_one_asked_for(self, paper: MapState, size: tuple[int, int]) -> None:
        width, height = size
        assert drawn_size(render(paper, Drawing(width=width, height=height))) == size

    @pytest.mark.parametrize("side", [SIDE_MIN, 390, 699, 700, 1280, SIDE_MAX])
    @pytest.mark.parametrize("layers", [DEFAULT_LAYERS, DEFAULT_LAYERS - {Layer.GRAPH}])
    def test_the_other_side_follows(
        self, paper: MapState, side: int, layers: frozenset[Layer]
    ) -> None:
        width, height = drawn_size(render(paper, Drawing(width=side, layers=layers)))
        assert width == side
        assert SIDE_MIN <= height <= SIDE_MAX
        width, height = drawn_size(render(paper, Drawing(height=side, layers=layers)))
        assert height == side
        assert SIDE_MIN <= width <= SIDE_MAX

    @pytest.mark.parametrize("side", [0, -1, SIDE_MIN - 1, SIDE_MAX + 1])
    def test_has_bounds(self, side: int) -> None:
        with pytest.raises(InvalidOptionError):
            Drawing(width=side)
        with pytest.raises(InvalidOptionError):
            Drawing(height=side)

    def test_a_map_of_many_zones_stays_within_them(self) -> None:
        zones = {f"z{i}": shapely.box(i, 0, i + 0.9, 1) for i in range(1_600)}
        picture = render(state_of(zones))
        assert max(drawn_size(picture)) <= SIDE_MAX
        assert "1600 zones and 0 passages: too many to draw" in texts(picture)
        assert len(picture) < 1_000_000

    @pytest.mark.parametrize("width", [390, 1280])
    def test_all_panels_lie_on_the_sheet(self, paper: MapState, width: int) -> None:
        for layers in (DEFAULT_LAYERS, {Layer.GRAPH}, {Layer.ZONES}, ALL_LAYERS):
            picture = render(paper, Drawing(width=width, layers=frozenset(layers)))
            high = drawn_size(picture)[1]
            moves = re.findall(r'translate\(([\d.]+) ([\d.]+)\)"><rect', picture)
            assert moves
            assert all(0 <= float(x) < width and 0 <= float(y) < high for x, y in moves)


class TestLayers:
    def test_each_has_marks_of_its_own(self, paper: MapState, path: list[Point]) -> None:
        """Without a layer, the picture is smaller; with nothing but it, it is not empty."""
        whole = render(paper, Drawing(trail=path, layers=ALL_LAYERS))
        nothing = render(paper, Drawing(trail=path, layers=frozenset()))
        assert nothing.count("<") < 12
        for layer in Layer:
            without = render(paper, Drawing(trail=path, layers=ALL_LAYERS - {layer}))
            alone = render(paper, Drawing(trail=path, layers=frozenset({layer})))
            assert without.count("<") < whole.count("<")
            assert layer is Layer.LEGEND or alone.count("<") > nothing.count("<") - 4

    def test_the_graph_alone_has_no_map(self, paper: MapState) -> None:
        words = texts(render(paper, Drawing(layers=frozenset({Layer.GRAPH}))))
        assert "Metric map" not in words
        assert words.count("corridor") == 1

    def test_are_read_from_words(self) -> None:
        assert read_layers("zones,graph") == {Layer.ZONES, Layer.GRAPH}
        for words in ("", "zones,", "walls", "zones, graph", "ZONES"):
            with pytest.raises(InvalidOptionError):
                read_layers(words)

    def test_doorways_lie_between_their_zones(self, paper: MapState) -> None:
        shown = titles(render(paper))
        assert {title for title in shown if "\u2013" in title} == {
            f"{room} \u2013 corridor" for room in "ABCD"
        }

    def test_frontiers_are_where_the_unknown_begins(self, paper: MapState) -> None:
        square = shapely.Polygon([(0, 0), (4, 0), (4, 4), (0, 4)])
        walls = state_of({"a": square})
        assert "stroke-dasharray" not in render(walls, Drawing(layers=frozenset({Layer.FRONTIERS})))
        assert "stroke-dasharray" in render(paper, Drawing(layers=ALL_LAYERS))


class TestRoute:
    ROUTE = DrawnRoute(((4.0, 7.0), (1.0, 7.0), (1.0, 1.0)), frozenset({("A", "corridor", 0)}))

    def test_is_drawn_on_both_sides(self, paper: MapState) -> None:
        plain, with_route = render(paper), render(paper, Drawing(route=self.ROUTE))
        assert ROUTE not in plain
        assert with_route.count(ROUTE) == 2 + 2 + 2  # line, ends, edge with its head, legend's
        assert "route" in texts(with_route)

    def test_is_on_the_picture_even_beyond_the_zones(self, paper: MapState) -> None:
        far = DrawnRoute(((4.0, 7.0), (99.0, 7.0)), frozenset())
        assert "90" in texts(render(paper, Drawing(route=far)))


def test_a_caption_stands_below(paper: MapState) -> None:
    assert "Step 29: <C>" in texts(render(paper, Drawing(caption="Step 29: <C>")))


def test_parallel_edges_lie_apart() -> None:
    zones = {"a": shapely.box(0, 0, 1, 1), "b": shapely.box(3, 0, 4, 1)}
    state = state_of(zones)
    edges = [Passage(*ends, (0.0, 0.0), 1, number)
             for ends in (("a", "b"), ("b", "a")) for number in range(3)]  # fmt: skip
    graph = TopologyGraph(state.graph.nodes, {edge.key: edge for edge in edges})
    picture = render(replace(state, graph=graph), Drawing(layers=frozenset({Layer.GRAPH})))
    curves = re.findall(r'd="M[^"]*Q([-\d.,]+) ', picture)
    assert len(set(curves)) == len(curves) == 6


class TestTrail:
    @given(st.integers(0, 5 * TRAIL_MAX))
    def test_is_thinned_and_ends_where_the_robot_is(self, count: int) -> None:
        trail = [(float(step), 0.0) for step in range(1, count + 1)]
        thin = thinned_trail(trail)
        assert len(thin) <= TRAIL_MAX + 1
        assert thin[-1:] == trail[-1:]
        assert {x % trail_stride(count) for x, _ in thin[:-1]} <= {0}
        if count <= TRAIL_MAX:
            assert thin == trail
