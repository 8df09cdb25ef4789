"""The zones of one scan: against the oracle, and what always holds."""

from __future__ import annotations

import math
from collections import Counter

import numpy as np
import pytest
import shapely
from hypothesis import given
from shapely.geometry.base import BaseGeometry

from semtopo.mapper import scan_world
from semtopo.runs import LabelledRuns, from_runs
from semtopo.scan import Scan
from semtopo.sensor import Sensor
from semtopo.sensor_map import SensorMap, extract
from semtopo.strips import find_strips
from semtopo.types import Edges, Kind, MappingOptions, Occupancy, Pose
from semtopo.world import World, WorldZone
from semtopo.zones import Zone
from tests import oracle
from tests.extents import claims_of
from tests.plans import THREE_IN_A_ROW, TWO_ROOMS, drawn
from tests.strategies import Scene, labelled_runs, many, options, poses, quick, scenes

ADJACENT = MappingOptions(edges=Edges.ADJACENT)
SAME = 1e-9


def apart(one: BaseGeometry, two: BaseGeometry) -> float:
    """Return the area that only one of two regions covers, in m^2."""
    return float(one.symmetric_difference(two).area)


def check_against(wanted: oracle.SensorMap, found: SensorMap) -> None:
    """Compare a sensor map with the oracle's: zones, here and links."""
    assert [zone.label for zone in found.zones] == list(wanted.zones)
    for zone in found.zones:
        assert apart(zone.region, wanted.zones[zone.label]) < SAME
    assert found.here == min(wanted.nearest, default=None)  # rounding must not decide (R7)
    check_links(wanted, found)


def check_links(wanted: oracle.SensorMap, found: SensorMap) -> None:
    """Compare the pairs, and the ground from which their points are taken."""
    assert [(link.source, link.target) for link in found.links] == [p for p, _ in wanted.entries]
    for link, (_, ground) in zip(found.links, wanted.entries, strict=True):
        assert apart(shapely.union_all(link.strips), ground) < SAME
        point = shapely.Point(link.nearest_point(found.position))
        assert ground.distance(point) < SAME
        distance = oracle.nearest(ground, found.position).distance
        assert math.dist(point.coords[0], found.position) == pytest.approx(distance, abs=SAME)


def check_sound(scan: Scan, found: SensorMap) -> None:
    """Check what holds of every sensor map."""
    labels = [zone.label for zone in found.zones]
    assert labels == sorted(set(labels))
    for zone in found.zones:
        assert zone.region.is_valid
        assert zone.region.area > 0
        check_border(zone)
    for link in found.links:
        assert link.source != link.target
        assert {link.source, link.target} <= set(labels)
    assert (found.here in labels) if labels else (found.here is None)
    assert found.position == scan.position


def check_border(zone: Zone) -> None:
    """Every border point is a vertex, stands once for each reason, and has a reason."""
    vertices = {tuple(xy) for xy in shapely.get_coordinates(zone.region).tolist()}
    xy, occupancy = zone.border.points()
    assert set(map(tuple, xy.tolist())) <= vertices
    assert (occupancy > Occupancy.NONE).all()


@quick
@given(scene=scenes(), chosen=options)
def test_extraction_from_worlds_equals_the_oracles(scene: Scene, chosen: MappingOptions) -> None:
    for position in scene.walk:
        found = extract(scan_world(scene.world, scene.sensor, position), chosen)
        wanted = oracle.extract(oracle.analyse(scene.world, scene.sensor, position), chosen)
        check_against(wanted, found)


@pytest.mark.parametrize("beams", [3, 8, 72])
def test_a_scan_that_goes_all_around_equals_the_oracles(beams: int) -> None:
    room = World([WorldZone("A", Kind.SPACE, (0.0, 0.0), (9.0, 5.0))])
    sensor, chosen = Sensor(beams, 2.0, 20), MappingOptions()
    for position in ((4.0, 2.5), (1.0, 1.5), (8.5, 4.75)):
        scan = scan_world(room, sensor, position)
        assert len(scan.intervals) == beams  # one on each beam, from the robot
        found = extract(scan, chosen)
        assert [sector.closed for zone in found.zones for sector in zone.sectors] == [True]
        check_against(oracle.extract(oracle.analyse(room, sensor, position), chosen), found)


@quick
@given(seen=labelled_runs(), pose=poses, chosen=options)
def test_extraction_from_runs_equals_the_oracles(
    seen: LabelledRuns, pose: Pose, chosen: MappingOptions
) -> None:
    found = extract(from_runs(pose, seen), chosen)
    check_against(oracle.extract(oracle.analyse_runs(pose, seen), chosen), found)


@quick
@given(scene=scenes(), chosen=options)
def test_zones_from_worlds_are_sound(scene: Scene, chosen: MappingOptions) -> None:
    for position in scene.walk:
        scan = scan_world(scene.world, scene.sensor, position)
        check_sound(scan, extract(scan, chosen))


@quick
@given(seen=labelled_runs(), pose=poses, chosen=options)
def test_zones_from_runs_are_sound(seen: LabelledRuns, pose: Pose, chosen: MappingOptions) -> None:
    scan = from_runs(pose, seen)
    check_sound(scan, extract(scan, chosen))


@quick
@given(scene=scenes())
def test_adjacent_zones_are_crossed_by_a_beam(scene: Scene) -> None:
    for position in scene.walk:
        found = extract(scan_world(scene.world, scene.sensor, position), ADJACENT)
        may = oracle.crossings(oracle.analyse(scene.world, scene.sensor, position))
        assert {(link.source, link.target) for link in found.links} <= may


def beams_of(*beams: list[tuple[str, float]], degrees: float = 30.0) -> Scan:
    """Return the scan of some beams of labelled runs, the first along x, up to 4 m."""
    seen = LabelledRuns(
        angle_min=0.0,
        angle_increment=math.radians(degrees),
        range_max=4.0,
        beams=beams,
        kinds={"door": Kind.PASSAGE, "fog": Kind.UNKNOWN},
    )
    return from_runs(Pose(0, 0), seen)


def wedge(near: float, far: float, degrees: float = 30.0) -> float:
    """Return the area of a strip between two beams."""
    return (far**2 - near**2) * math.sin(math.radians(degrees)) / 2


def test_an_interval_with_two_partners_joins_both() -> None:
    whole = [("door", 0.5), ("a", 4.0)]
    parts = [("door", 0.5), ("a", 1.0), ("fog", 2.0), ("a", 4.0)]
    scan = beams_of(whole, parts)
    assert Counter(find_strips(scan).left.tolist()) == {0: 2}
    (zone,) = extract(scan, MappingOptions()).zones
    wanted = oracle.extract(oracle.analyse_runs(Pose(0, 0), _runs_of(whole, parts)), ADJACENT)
    assert apart(zone.region, wanted.zones["a"]) < SAME
    # two quadrilaterals over one interval overlap, and what they share counts once
    assert zone.region.area < shapely.area(find_strips(scan).polygons(slice(None))).sum()


def _runs_of(*beams: list[tuple[str, float]]) -> LabelledRuns:
    return LabelledRuns(
        angle_min=0.0,
        angle_increment=math.radians(30),
        range_max=4.0,
        beams=beams,
        kinds={"door": Kind.PASSAGE, "fog": Kind.UNKNOWN},
    )


def test_a_fan_that_is_no_ring_does_not_close() -> None:
    (zone,) = extract(beams_of(*[[("a", 1.0)]] * 4, degrees=80.0), MappingOptions()).zones
    assert zone.region.area == pytest.approx(3 * wedge(0, 1, 80))
    (zone,) = extract(beams_of(*[[("a", 1.0)]] * 4, degrees=90.0), MappingOptions()).zones
    assert zone.region.area == pytest.approx(2.0)


def test_strips_without_area_are_no_zone() -> None:
    """An interval that opens at the last sample is a point; two of them are a line."""
    scan = scan_world(drawn(TWO_ROOMS), Sensor(360, 1.0, 10), (2.05, 2.5))
    labels = {scan.labels[number] for number in scan.intervals.label.tolist()}
    assert labels == {"a"}
    scan = scan_world(drawn(TWO_ROOMS), Sensor(360, 2.0, 20), (2.05, 2.5))
    points = scan.intervals.near == scan.intervals.far
    assert points.any()
    assert (shapely.area(find_strips(scan).polygons(slice(None))) > 0).all()


def test_border_of_a_room() -> None:
    """Four beams in a room with a door: three ends at walls, one in the doorway."""
    scan = scan_world(drawn(TWO_ROOMS), Sensor(4, 2.0, 20), (2.03, 2.53))
    (zone,) = extract(scan, MappingOptions()).zones
    why = {(round(x, 2), round(y, 2)): it for (x, y), it in claims_of(zone.border).items()}
    assert set(why) == {(2.03, 3.93), (2.93, 2.53), (2.03, 1.03), (1.03, 2.53)}
    assert why[(2.93, 2.53)] == Occupancy.PASSAGE
    assert why[(1.03, 2.53)] == Occupancy.OBSTACLE


def test_far_room_has_passage_and_wall_points() -> None:
    scan = scan_world(drawn(THREE_IN_A_ROW), Sensor(360, 6.0, 120), (2.53, 2.53))
    zones = {zone.label: zone for zone in extract(scan, MappingOptions()).zones}
    assert set(zones) == {"a", "b", "c"}
    wanted = {Occupancy.PASSAGE, Occupancy.OBSTACLE}
    assert wanted <= set(map(Occupancy, zones["b"].border.occupancy.tolist()))


@pytest.mark.parametrize("heading", range(12))
def test_a_full_turn_whose_last_beam_is_the_first_again(heading: int) -> None:
    """Lasers that report both -pi and +pi: the last strip and the first may overlap by a hair."""
    radii = [1.0 + (7 * number % 11) / 10 for number in range(361)]
    seen = LabelledRuns(
        angle_min=-math.pi,
        angle_increment=math.radians(1),
        range_max=4.0,
        beams=[[("a", radius)] for radius in radii],
        kinds={},
    )
    pose = Pose(1.1 * heading, 2.3, 0.037 * heading)
    (zone,) = extract(from_runs(pose, seen), MappingOptions()).zones
    assert zone.region.is_valid, shapely.is_valid_reason(zone.region)


def test_a_full_turn_with_rounded_increments() -> None:
    seen = LabelledRuns(
        angle_min=-math.pi,
        angle_increment=0.0174533,
        range_max=4.0,
        beams=[[("a", 1.0 + (7 * number % 11) / 10)] for number in range(361)],
        kinds={},
    )
    (zone,) = extract(from_runs(Pose(1.1, 2.3, 0.3), seen), MappingOptions()).zones
    assert zone.region.is_valid, shapely.is_valid_reason(zone.region)


def test_two_beams_span_one_triangle() -> None:
    """Two beams less than half a turn apart: either way round, the strip is the same."""
    (zone,) = extract(beams_of([("a", 1.0)], [("a", 1.0)], degrees=160), MappingOptions()).zones
    assert zone.region.area == pytest.approx(wedge(0, 1, 160))


def test_runs_are_not_vacuous() -> None:
    """Of the drawn runs, most show two zones, and many an interval with two partners."""
    counts: Counter[str] = Counter()

    @many
    @given(seen=labelled_runs(), pose=poses)
    def count(seen: LabelledRuns, pose: Pose) -> None:
        scan = from_runs(pose, seen)
        strips = find_strips(scan)
        counts["all"] += 1
        counts["zones"] += len(extract(scan, MappingOptions()).zones) >= 2
        counts["doubles"] += any(
            len(np.unique(side)) < len(side) for side in (strips.left, strips.right)
        )
        counts["fans"] += not scan.fan.ring

    count()
    assert counts["zones"] > 0.9 * counts["all"]
    assert counts["doubles"] > 0.25 * counts["all"]
    assert counts["fans"] > 0.2 * counts["all"]
