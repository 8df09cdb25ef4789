"""Borders in pieces: walls, passages and frontiers, all around and nothing twice."""

from __future__ import annotations

import pytest
import shapely
from hypothesis import given

from semtopo.borders import BorderPiece, border_pieces
from semtopo.geometry import Region
from semtopo.mapper import explore
from semtopo.metric import MappedZone
from semtopo.types import Occupancy
from tests.extents import marked
from tests.strategies import Scene, scenes

SQUARE = shapely.Polygon([(0, 0), (4, 0), (4, 4), (0, 4)])


def zone(region: Region, claims: dict[tuple[float, float], Occupancy]) -> MappedZone:
    return MappedZone("a", "a", marked(region, claims), since=1, seq=1)


def length(pieces: tuple[BorderPiece, ...], occupancy: Occupancy) -> float:
    chosen = [shapely.LineString(one.line) for one in pieces if one.occupancy is occupancy]
    return float(shapely.length(chosen).sum())


def test_a_side_between_two_walls_is_wall() -> None:
    claims = {(0.0, 0.0): Occupancy.OBSTACLE, (4.0, 0.0): Occupancy.OBSTACLE,
              (4.0, 4.0): Occupancy.FREE, (0.0, 4.0): Occupancy.PASSAGE}  # fmt: skip
    pieces = border_pieces(zone(SQUARE, claims))
    assert length(pieces, Occupancy.OBSTACLE) == 4
    assert length(pieces, Occupancy.FREE) == 8
    assert length(pieces, Occupancy.PASSAGE) == 4


def test_a_border_of_one_kind_is_one_closed_piece() -> None:
    (piece,) = border_pieces(zone(SQUARE, {}))
    assert piece.occupancy is Occupancy.FREE
    assert piece.line[0].tolist() == piece.line[-1].tolist()


def test_a_point_without_a_claim_takes_its_neighbours() -> None:
    (piece,) = border_pieces(
        zone(SQUARE, {(0.0, 0.0): Occupancy.OBSTACLE, (4.0, 4.0): Occupancy.OBSTACLE})
    )
    assert piece.occupancy is Occupancy.OBSTACLE


def test_holes_and_parts_have_borders_too() -> None:
    holed = SQUARE.difference(shapely.box(1, 1, 2, 2))
    region = shapely.union(holed, shapely.box(9, 9, 10, 10))
    assert isinstance(region, Region)
    assert length(border_pieces(zone(region, {})), Occupancy.FREE) == pytest.approx(24)


@given(scene=scenes())
def test_the_pieces_are_all_of_the_border(scene: Scene) -> None:
    *_, last = explore(scene.world, scene.sensor, scene.walk)
    for one in last.state.metric.zones.values():
        pieces = border_pieces(one)
        assert all(len(piece.line) > 1 for piece in pieces)
        total = sum(length(pieces, occupancy) for occupancy in set(Occupancy))
        assert total == pytest.approx(one.region.length)
