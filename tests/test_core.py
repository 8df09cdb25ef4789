"""Reduced borders (R17): few points, near the unreduced ones, and no drift."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from random import Random

import numpy as np
import pytest
import shapely
import shapely.affinity
from hypothesis import given

from semtopo.borders import border_pieces
from semtopo.core import RIM, Core
from semtopo.formats import read_path, read_world
from semtopo.fusion import Extent
from semtopo.geometry import Region
from semtopo.mapper import MapState, explore
from semtopo.metric import MappedZone
from semtopo.sensor import Sensor
from semtopo.types import MappingOptions, Occupancy, Point, Sensing
from semtopo.wkb import shape_bytes, shape_from
from tests.regions import tiles
from tests.strategies import Scene, patient, scenes

EXAMPLE = Path(__file__).parents[1] / "examples" / "paper"
TOLERANCE = 0.02


@cache
def run(tolerance: float, laps: int) -> list[MapState]:
    """Return the map after each lap of the paper's path, each a little beside the one before."""
    world = read_world((EXAMPLE / "world.json").read_bytes())
    path = [pose.position for pose in read_path((EXAMPLE / "path.csv").read_bytes())]
    chance = Random(5)
    walk: list[Point] = [
        (x + chance.uniform(-0.1, 0.1), y + chance.uniform(-0.1, 0.1))
        for _ in range(laps)
        for x, y in path
    ]
    options = MappingOptions(tolerance=tolerance)
    states = [step.state for step in explore(world, Sensor(36, 2.0, 20), walk, options)]
    return states[len(path) - 1 :: len(path)]


def vertices(state: MapState) -> int:
    return sum(int(shapely.get_num_coordinates(it.region)) for it in state.metric.zones.values())


def farthest(region: Region, other: Region) -> float:
    """Return how far the border of a region lies from that of another, at most, in m."""
    places = shapely.points(shapely.get_coordinates(shapely.segmentize(region.boundary, 0.02)))
    return float(shapely.distance(other.boundary, places).max())


@pytest.mark.parametrize("lap", [0, 3, 11])
def test_borders_lie_within_the_tolerance_of_the_unreduced_ones(lap: int) -> None:
    reduced, whole = run(TOLERANCE, 12)[lap], run(0.0, 12)[lap]
    assert list(reduced.metric.zones) == list(whole.metric.zones)
    assert reduced.graph.pairs == whole.graph.pairs
    for zone_id, zone in reduced.metric.zones.items():
        wanted = whole.metric.zones[zone_id].region
        assert zone.region.is_valid
        assert farthest(zone.region, wanted) <= TOLERANCE
        assert zone.region.symmetric_difference(wanted).area <= TOLERANCE * wanted.length


def test_few_vertices_are_left_and_their_number_does_not_grow() -> None:
    counts = [vertices(state) for state in run(TOLERANCE, 12)]
    assert counts[-1] < counts[0]
    assert vertices(run(0.0, 12)[-1]) > 5 * counts[-1]


def test_a_core_lies_within_all_scans_and_they_within_its_rim() -> None:
    laps = run(TOLERANCE, 12)
    whole = run(0.0, 12)[-1]
    for zone_id, zone in laps[-1].metric.zones.items():
        assert zone.core is not None
        beyond = zone.core.region.difference(whole.metric.zones[zone_id].region)
        assert beyond.area < 1e-9
        assert zone.core.rim.covers(whole.metric.zones[zone_id].region)


def test_corners_of_walls_stay() -> None:
    world = read_world((EXAMPLE / "world.json").read_bytes())
    path = [pose.position for pose in read_path((EXAMPLE / "path.csv").read_bytes())]
    options = MappingOptions(sensing=Sensing.EXACT, tolerance=TOLERANCE)
    *_, last = explore(world, Sensor(360, 2.0, 20), path, options)
    room = last.state.metric.zones["A"].region
    corners = shapely.points([(3, 5.75), (5.75, 5.75), (5.75, 8), (3, 8)])
    seen = [corner for corner in corners if room.distance(corner) < TOLERANCE]
    assert len(seen) >= 2
    ends = shapely.MultiPoint(shapely.get_coordinates(room))
    assert all(ends.distance(corner) < 2 * TOLERANCE for corner in seen)


def test_pieces_keep_their_occupancy_and_are_few() -> None:
    zones = run(TOLERANCE, 12)[-1].metric.zones
    pieces = border_pieces(zones["corridor"])
    assert {piece.occupancy for piece in pieces} >= {Occupancy.OBSTACLE, Occupancy.PASSAGE}
    assert len(pieces) < 100
    doors = [(2.0, 7.0), (7.6, 9.0), (10.0, 4.1), (4.4, 2.0)]
    passages = shapely.MultiLineString(
        [it.line for it in pieces if it.occupancy is Occupancy.PASSAGE]
    )
    for door in doors:
        assert passages.distance(shapely.Point(door)) < 0.5  # half the door
    for piece in pieces:
        line = shapely.LineString(piece.line)
        assert zones["corridor"].region.boundary.distance(line) <= 2 * TOLERANCE
        assert len(piece.line) >= 2


def test_a_zone_is_stored_with_its_core() -> None:
    for zone in run(TOLERANCE, 12)[-1].metric.zones.values():
        ground, core = shape_from(*shape_bytes(zone))
        assert core is not None
        assert zone.core is not None
        assert ground.region.equals_exact(zone.region)
        assert core.region.equals_exact(zone.core.region)
        assert core.tolerance == TOLERANCE
        np.testing.assert_array_equal(core.border.xy, zone.core.border.xy)
        np.testing.assert_array_equal(core.border.marks, zone.core.border.marks)
        np.testing.assert_array_equal(ground.border.marks, zone.border.marks)


def test_a_zone_without_tolerance_is_stored_without() -> None:
    zone = next(iter(run(0.0, 12)[0].metric.zones.values()))
    assert shape_from(*shape_bytes(zone))[1] is None
    assert zone.core is None


def square() -> Core:
    return Core(Extent.of(shapely.box(0, 0, 4, 4)), 0.1)


def test_what_lies_within_the_rim_changes_nothing() -> None:
    core = square()
    near, beyond = (
        Extent.of(shapely.box(1, 1, 1.5, 4 + share * RIM * 0.1)) for share in (0.99, 1.01)
    )
    assert core.grown(near) is core
    grown = core.grown(beyond)
    assert grown.region.equals(core.region.union(beyond.region))
    assert grown.grown(near) is grown


def test_a_core_seen_again_and_again_creeps_nowhere() -> None:
    """Each look goes beyond the last by less than the rim: in the end, all of them count."""
    core = square()
    for step in range(1, 101):
        core = core.grown(Extent.of(shapely.box(1, 1, 3, 4 + step * 0.001)))
    assert 4.1 - RIM * 0.1 <= core.region.bounds[3] <= 4.1
    assert farthest(core.reduced().region, core.region) <= 0.1


@patient
@given(scene=scenes())
def test_any_map_lies_within_its_tolerance(scene: Scene) -> None:
    whole = [step.state for step in explore(scene.world, scene.sensor, scene.walk)]
    options = MappingOptions(tolerance=0.05)
    reduced = [step.state for step in explore(scene.world, scene.sensor, scene.walk, options)]
    for one, other in zip(whole, reduced, strict=True):
        assert one.graph.pairs == other.graph.pairs
        for zone_id, zone in other.metric.zones.items():
            wanted: MappedZone = one.metric.zones[zone_id]
            assert zone.region.is_valid
            assert (
                zone.region.symmetric_difference(wanted.region).area <= 0.05 * wanted.region.length
            )


def test_a_core_takes_in_what_its_rim_does_not_cover() -> None:
    """Whether that is seen from the vertices, or from the rim, which is then ready for the next."""
    taken = 0
    for seed in range(60):
        chance = Random(seed)
        core = Core(Extent.of(tiles(chance)), 0.4)
        shift = 10 ** chance.uniform(-3, 0)
        seen = Extent.of(shapely.affinity.translate(core.region, shift, -shift / 2))
        covered = Core(core.extent, core.tolerance).rim.covers(seen.region)
        assert (core.grown(seen) is core) == covered
        assert core.rim.covers(core.region)
        assert (core.grown(seen) is core) == covered  # now that the rim is there
        taken += not covered
    assert 10 < taken < 50
