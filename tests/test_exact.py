"""Exact sensing (R16): borders are where the walls are."""

from __future__ import annotations

import math
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import shapely
from hypothesis import given
from shapely import Polygon

from semtopo.errors import InvalidPoseError, InvalidSensorError
from semtopo.formats import read_path, read_world
from semtopo.geometry import Region, polygonal
from semtopo.mapper import MapState, explore, scan_world
from semtopo.sensor import Sensor, measure, trace
from semtopo.sensor_map import extract
from semtopo.types import NOWHERE, Kind, MappingOptions, Occupancy, Point, Sensing
from semtopo.world import World, WorldZone
from tests.plans import TWO_ROOMS, drawn
from tests.strategies import Scene, quick, scenes

EXAMPLE = Path(__file__).parents[1] / "examples" / "paper"
SAME = 1e-9
EXACT = MappingOptions(sensing=Sensing.EXACT)


@cache
def world() -> World:
    return read_world((EXAMPLE / "world.json").read_bytes())


@cache
def path() -> list[Point]:
    return [pose.position for pose in read_path((EXAMPLE / "path.csv").read_bytes())]


def painted(plan: World) -> tuple[dict[str, Region], Region]:
    """Return the ground of each space, and that of all obstacles inside the plan."""
    spaces: dict[str, Region] = {}
    walls: Region = Polygon()
    for zone in plan.zones:
        ground = shapely.box(*zone.low, *zone.high)
        spaces = {name: polygonal(region.difference(ground)) for name, region in spaces.items()}
        walls = polygonal(walls.difference(ground))
        if zone.kind is Kind.OBSTACLE:
            walls = polygonal(walls.union(ground))
        elif zone.kind is Kind.SPACE:
            spaces[zone.label] = polygonal(spaces.get(zone.label, Polygon()).union(ground))
    return spaces, walls


def visible(position: Point, walls: Region, reach: float) -> Region:
    """Return what is seen from a position: a disc, without walls and the shadows of their sides."""
    place = np.array(position)
    rings = [shapely.get_coordinates(ring) for ring in shapely.get_rings(shapely.get_parts(walls))]
    sides = np.concatenate([np.stack([ring[:-1], ring[1:]], axis=1) for ring in rings])
    away = sides - place
    far = place + away * (50 * reach / np.linalg.norm(away, axis=2, keepdims=True))
    corners = np.concatenate([sides, far], axis=1)
    hulls = [shapely.MultiPoint(four).convex_hull for four in corners]
    shadows = [hull for hull in hulls if hull.area > SAME]
    dark = shapely.union_all([walls, *shadows])
    return polygonal(shapely.Point(position).buffer(reach, quad_segs=180).difference(dark))


@cache
def truth() -> dict[str, Region]:
    """Return the ground of each space that is seen from anywhere along the path."""
    spaces, walls = painted(world())
    outside = shapely.box(-9, -9, 99, 99).difference(shapely.box(0, 0, 12, 11))
    walls = polygonal(walls.union(outside))
    seen = shapely.union_all([visible(position, walls, 2.0) for position in path()])
    return {label: polygonal(ground.intersection(seen)) for label, ground in spaces.items()}


@cache
def mapped(beams: int, sensing: Sensing) -> MapState:
    options = MappingOptions(sensing=sensing)
    *_, last = explore(world(), Sensor(beams, 2.0, 20), path(), options)
    return last.state


@pytest.mark.parametrize(("sensing", "least"), [(Sensing.EXACT, 0.99), (Sensing.SAMPLED, 0.95)])
def test_zones_are_what_is_truly_visible(sensing: Sensing, least: float) -> None:
    zones = mapped(360, sensing).metric.zones
    assert set(zones) == set(truth()) == {"corridor", "A", "B", "C", "D"}
    for label, wanted in truth().items():
        region = zones[label].region
        overlap = region.intersection(wanted).area / region.union(wanted).area
        assert overlap >= least, label


def test_the_ends_of_beams_are_on_the_walls() -> None:
    scan = scan_world(drawn(TWO_ROOMS), Sensor(16, 9.0, 2), (1.75, 2.5), sensing=Sensing.EXACT)
    labels = [scan.labels[number] for number in scan.intervals.label.tolist()]
    east = scan.intervals.beam == 4
    assert [label for label, chosen in zip(labels, east, strict=True) if chosen] == ["a", "b"]
    x = np.concatenate([scan.near_points(east), scan.far_points(east)])[:, 0]
    np.testing.assert_allclose(x % 1, np.where(x == 1.75, 0.75, 0), atol=1e-9)


@quick
@given(scene=scenes())
def test_every_sample_reads_as_the_piece_of_beam_it_lies_on(scene: Scene) -> None:
    """But for samples at the very end of a piece, where another zone may lie on top."""
    for position in scene.walk:
        seen, sensor = trace(scene.world, scene.sensor, position), scene.sensor
        sampled = measure(scene.world, sensor, position)
        for beam, surface, near, far in zip(
            seen.beam.tolist(), seen.surface.tolist(), seen.near, seen.far, strict=True
        ):
            on_it = (sensor.radii > near + 1e-9) & (sensor.radii < far - 1e-9)
            assert (sampled.surface[beam, on_it] == surface).all()


@quick
@given(scene=scenes())
def test_pieces_of_a_beam_are_all_of_it(scene: Scene) -> None:
    seen = trace(scene.world, scene.sensor, scene.walk[0])
    lengths = np.bincount(seen.beam, seen.far - seen.near, minlength=scene.sensor.beams)
    np.testing.assert_allclose(lengths, scene.sensor.range, atol=1e-9)
    assert (seen.near < seen.far).all()


@quick
@given(scene=scenes())
def test_zones_are_sound_and_lie_in_their_spaces(scene: Scene) -> None:
    spaces, _ = painted(scene.world)
    for position in scene.walk:
        scan = scan_world(scene.world, scene.sensor, position, sensing=Sensing.EXACT)
        for zone in extract(scan, EXACT).zones:
            assert zone.region.is_valid
            assert zone.label in spaces
            vertices = {tuple(xy) for xy in shapely.get_coordinates(zone.region).tolist()}
            points, _ = zone.border.points()
            assert {tuple(xy) for xy in points.tolist()} <= vertices
            ends = shapely.points(points)
            assert (shapely.distance(spaces[zone.label], ends) < 1e-9).all()


def test_straight_walls_have_no_points_but_where_their_kind_changes() -> None:
    room = World([
        WorldZone("a", Kind.SPACE, (0, 0), (2, 2)),
        WorldZone("door", Kind.PASSAGE, (2, 0.5), (3, 1)),
        WorldZone("b", Kind.SPACE, (3, 0), (5, 2)),
    ])  # fmt: skip
    scan = scan_world(room, Sensor(360, 9.0, 2), (1.0, 1.0), sensing=Sensing.EXACT)
    zone = extract(scan, EXACT).zones[0]
    assert shapely.get_num_coordinates(zone.region) <= 4 * 2 + 4 + 1  # corners are cut; the door
    assert zone.region.area == pytest.approx(4, rel=1e-3)
    xy, occupancy = zone.border.points()
    at_door = xy[occupancy == Occupancy.PASSAGE]
    np.testing.assert_allclose(at_door, [(2, 0.5), (2, 1)], atol=0.05)


def test_beams_along_an_edge_belong_to_the_later_zone() -> None:
    pair = [WorldZone("a", Kind.SPACE, (0, 0), (1, 2)), WorldZone("b", Kind.SPACE, (1, 0), (2, 2))]
    for zones, wanted in ((pair, "b"), (pair[::-1], "a")):
        plan = World(zones)
        seen = trace(plan, Sensor(4, 1.0, 2), (1.0, 1.0))
        labels = [plan.labels[n] if n != NOWHERE else "" for n in seen.surfaces.label[seen.surface]]
        assert labels[0] == labels[2] == wanted


def test_the_sensor_sees_no_farther_than_its_range() -> None:
    plan = World([WorldZone("a", Kind.SPACE, (-9, -9), (9, 9))])
    scan = scan_world(plan, Sensor(90, 2.5, 2), (0.1, 0.2), sensing=Sensing.EXACT)
    assert (scan.intervals.far == 2.5).all()
    assert (scan.intervals.far_occupancy == Occupancy.FREE).all()


@pytest.mark.parametrize("position", [(math.nan, 0.0), (0.0, math.inf)])
def test_a_position_must_be_finite(position: Point) -> None:
    with pytest.raises(InvalidPoseError):
        trace(world(), Sensor(), position)


def test_too_many_edges_in_reach_are_refused() -> None:
    ends = np.linspace(0, 1, 6_000)
    crowd = World([WorldZone("a", Kind.SPACE, (e, e), (e + 2, e + 2)) for e in ends.tolist()])
    with pytest.raises(InvalidSensorError, match="too many edges"):
        trace(crowd, Sensor(beams=720), (0.5, 0.5))
    assert len(trace(crowd, Sensor(beams=4), (0.5, 0.5)).beam) > 4
