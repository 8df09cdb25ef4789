"""Triangles of a region: they tile it, and know who lies beside them."""

from __future__ import annotations

from random import Random

import networkx as nx
import numpy as np
import pytest
from shapely import MultiPolygon, Polygon, box

from semtopo.geometry import Region, polygonal
from semtopo.inset import inset, sides
from semtopo.triangulation import WALL, Triangulation, triangulate
from tests.regions import DRAWS, Draw, far_away, stars

L_SHAPE = Polygon([(0, 0), (4, 0), (4, 1), (1, 1), (1, 4), (0, 4)])


def triangles(mesh: Triangulation) -> list[Polygon]:
    return [
        Polygon([mesh.points[mesh.origins[edge]] for edge in range(first, first + 3)])
        for first in range(0, len(mesh.origins), 3)
    ]


@pytest.mark.parametrize("draw", [*DRAWS, far_away(stars)], ids=lambda draw: draw.__name__)
def test_triangles_tile_a_region(draw: Draw) -> None:
    for seed in range(5):
        region = inset(draw(Random(seed)), 0)
        mesh = triangulate(region)
        assert sum(one.area for one in triangles(mesh)) == pytest.approx(region.area, rel=1e-9)
        assert all(one.exterior.is_ccw for one in triangles(mesh))
        assert mesh.twins.count(WALL) == len(sides(region))


def test_twins_run_along_each_other() -> None:
    mesh = triangulate(inset(stars(Random(3)), 0))
    inner = [edge for edge, twin in enumerate(mesh.twins) if twin != WALL]
    assert len(inner) > 100
    for edge in inner:
        twin = mesh.twins[edge]
        assert mesh.twins[twin] == edge
        assert mesh.origins[twin] == mesh.origins[mesh.following[edge]]
        assert mesh.origins[mesh.following[twin]] == mesh.origins[edge]


def test_half_edges_go_round_their_triangle() -> None:
    mesh = triangulate(L_SHAPE)
    for edge in range(len(mesh.origins)):
        assert mesh.preceding[mesh.following[edge]] == edge
        assert mesh.following[edge] // 3 == edge // 3
        assert mesh.following[mesh.following[mesh.following[edge]]] == edge


def neighbours(mesh: Triangulation) -> nx.MultiGraph[int]:
    """Return who lies beside whom."""
    graph: nx.MultiGraph[int] = nx.MultiGraph()
    graph.add_nodes_from(range(len(mesh.twins) // 3))
    pairs = [(edge // 3, twin // 3) for edge, twin in enumerate(mesh.twins) if twin > edge]
    graph.add_edges_from(pairs)
    return graph


@pytest.mark.parametrize("draw", DRAWS, ids=lambda draw: draw.__name__)
def test_only_dead_ends_have_exits(draw: Draw) -> None:
    """What is on no way round, and on none between two such, is a dead end but for one place."""
    dead = 0
    for seed in range(5):
        mesh = triangulate(inset(draw(Random(seed)), 0))
        graph = neighbours(mesh)
        for part in nx.connected_components(graph):
            core = set(nx.k_core(nx.Graph(graph.subgraph(part)), 2))
            open_ones = {triangle for triangle in part if mesh.exits[triangle] == WALL}
            assert open_ones == core if core else len(open_ones) == 1
            dead += len(part - open_ones)
    assert dead > 20


def test_exits_lead_out_of_dead_ends() -> None:
    mesh = triangulate(inset(stars(Random(3)), 0))
    deepest = 0
    for first in range(len(mesh.exits)):
        triangle, passed = first, {first}
        while mesh.exits[triangle] != WALL:
            assert mesh.exits[triangle] // 3 == triangle
            triangle = mesh.twins[mesh.exits[triangle]] // 3
            assert triangle not in passed
            passed.add(triangle)
        deepest = max(deepest, len(passed))
    assert deepest > 3


@pytest.mark.parametrize(
    ("region", "corners"),
    [
        (box(0, 0, 1, 1), set()),
        (L_SHAPE, {(1, 1)}),
        (polygonal(box(0, 0, 3, 3).difference(box(1, 1, 2, 2))), {(1, 1), (1, 2), (2, 1), (2, 2)}),
        (MultiPolygon([L_SHAPE, box(9, 9, 10, 10)]), {(1, 1)}),
    ],
)
def test_paths_bend_where_the_region_does(region: Region, corners: set[tuple[int, int]]) -> None:
    mesh = triangulate(region)
    bends = [point for point, corner in zip(mesh.points, mesh.corners, strict=True) if corner]
    assert set(bends) == corners


def test_a_place_is_found_in_each_triangle_that_it_touches() -> None:
    mesh = triangulate(inset(stars(Random(5)), 0))
    shapes = triangles(mesh)
    random = Random(0)
    for _ in range(60):
        number = random.randrange(len(shapes))
        weights = np.array([random.random() for _ in range(3)])
        x, y = weights @ np.array(shapes[number].exterior.coords[:3]) / weights.sum()
        assert number in mesh.locate((x, y))
    for vertex in random.sample(range(len(mesh.points)), 30):
        around = {edge // 3 for edge, origin in enumerate(mesh.origins) if origin == vertex}
        assert around <= set(mesh.locate(mesh.points[vertex]))


def test_a_place_off_by_rounding_is_in_the_nearest_triangle() -> None:
    mesh = triangulate(box(0, 0, 1, 1))
    assert mesh.locate((0.5, -1e-7)) == mesh.locate((0.5, 1e-7))
