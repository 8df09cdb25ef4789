"""The readings of the paper, R1 to R15, one test each."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from shapely import MultiPolygon, Polygon

from semtopo.errors import InvalidSensorError
from semtopo.mapper import MapState, Step, explore, scan_world, step
from semtopo.runs import LabelledRuns, from_runs
from semtopo.sensor import Sensor, measure
from semtopo.sensor_map import SensorMap, extract
from semtopo.types import Edges, Kind, MappingOptions, Occupancy, Point, Pose
from semtopo.world import World, WorldZone
from tests.oracle import Interval
from tests.plans import LOOP, THREE_IN_A_ROW, TOUCHING, TWO_DOORS, TWO_ROOMS, drawn
from tests.test_scan import spelled

SEEN, ADJACENT = MappingOptions(), MappingOptions(edges=Edges.ADJACENT)
FINE = Sensor(beams=72, range=4.0, samples=40)
NONE, FREE, PASSAGE, OBSTACLE = Occupancy


def look(
    world: World, position: Point, options: MappingOptions = SEEN, sensor: Sensor = FINE
) -> SensorMap:
    """Return the sensor map of one position."""
    return extract(scan_world(world, sensor, position), options)


def last(world: World, *path: Point, options: MappingOptions = SEEN) -> Step:
    """Return the last step of a drive."""
    *_, taken = explore(world, FINE, path, options)
    return taken


def beam_east(art: str, position: Point, sensor: Sensor) -> list[Interval]:
    """Return the intervals on the beam along +x."""
    scan = scan_world(drawn(art), sensor, position)
    return spelled(scan)[sensor.beams // 4]


def told(*beams: list[tuple[str, float]], degrees: float = 20.0) -> SensorMap:
    """Return the sensor map of labelled runs, with neighbours only linked."""
    kinds = {"door": Kind.PASSAGE, "fog": Kind.UNKNOWN}
    seen = LabelledRuns(
        angle_min=0.0,
        angle_increment=math.radians(degrees),
        range_max=4.0,
        beams=beams,
        kinds=kinds,
    )
    return extract(from_runs(Pose(0, 0), seen), ADJACENT)


def pairs(found: SensorMap) -> set[str]:
    """Return the links of a sensor map of one-letter labels."""
    return {link.source + link.target for link in found.links}


def test_r1_bearings_divide_by_the_number_of_beams_and_turn_clockwise_from_y() -> None:
    sensor = Sensor(beams=8, samples=20)
    angles = [2 * math.pi * i / 8 for i in range(8)]
    wanted = [[math.sin(angle), math.cos(angle)] for angle in angles]
    np.testing.assert_allclose(sensor.fan.directions, wanted, atol=1e-15)
    np.testing.assert_allclose(sensor.fan.directions[:3, 0], [0, math.sqrt(0.5), 1], atol=1e-15)


def test_r2_a_beam_ends_at_its_first_obstacle() -> None:
    found = beam_east("aa#aa+b#", (0.5, 0.5), Sensor(4, 8.0, 8))
    assert found == [Interval("a", 0, 1, NONE, OBSTACLE, "", from_robot=True)]


def test_r3_a_passage_before_an_obstacle_makes_no_node() -> None:
    """A door that leads against a wall, and the jambs of one that does not."""
    assert [zone.label for zone in look(drawn("#aa+#"), (1.5, 0.5)).zones] == ["a"]
    (piece,) = beam_east("#aa+#", (1.55, 0.5), Sensor(4, 3.0, 30))
    assert piece.far_occupancy is PASSAGE
    for beams in (36, 72, 360):
        found = look(drawn(TWO_ROOMS), (2.03, 2.53), sensor=Sensor(beams, 4.0, 40))
        assert [zone.label for zone in found.zones] == ["a", "b"]


def test_r4_painters_order_closed_rectangles_and_obstacle_outside() -> None:
    floor = WorldZone("floor", Kind.SPACE, (0, 0), (4, 4))
    rug = WorldZone("rug", Kind.PASSAGE, (1, 1), (2, 2))
    labels, kinds = World([floor, rug]).read(
        np.array([(1.5, 1.5), (1, 1), (2, 2), (0, 0), (4, 4), (4.01, 4)])
    )
    assert labels.tolist() == [1, 1, 1, 0, 0, -1]
    assert kinds.tolist() == [1, 1, 1, 0, 0, Kind.OBSTACLE]
    assert World([rug, floor]).read(np.array([1.5, 1.5]))[0] == 1


def test_r4_the_robots_own_cell_is_not_sampled_and_two_samples_are_needed() -> None:
    seen = measure(drawn("#a#"), Sensor(4, 1.0, 2), (1.5, 0.5))
    nearest = np.linalg.norm(seen.xy - (1.5, 0.5), axis=-1).min()
    assert nearest == pytest.approx(0.5)
    with pytest.raises(InvalidSensorError):
        Sensor(samples=1)


def test_r5_two_spaces_that_touch_have_a_passage_of_no_width_between_them() -> None:
    first, second = beam_east(TOUCHING, (1.55, 1.53), Sensor(4, 3.0, 30))
    assert (first.label, first.far_occupancy) == ("a", PASSAGE)
    assert (second.label, second.near_occupancy, second.source) == ("b", PASSAGE, "a")
    assert second.near - first.far == pytest.approx(0.1)
    for options in (SEEN, ADJACENT):
        assert pairs(look(drawn(TOUCHING), (1.55, 1.53), options)) == {"ab"}


def test_r6_intervals_start_at_the_robot_or_behind_a_passage() -> None:
    first, second = beam_east(TWO_ROOMS, (2.05, 2.5), Sensor(4, 4.0, 40))
    assert (first.label, first.near, round(first.far, 9)) == ("a", 0.0, 0.9)
    assert (second.label, round(second.near, 9), round(second.far, 9)) == ("b", 2.0, 3.9)


def test_r6_an_interval_that_opens_at_the_last_sample_ends_where_it_starts() -> None:
    _, second = beam_east(TWO_ROOMS, (2.05, 2.5), Sensor(4, 2.0, 20))
    assert second.near == second.far == 2.0
    assert second.far_occupancy is NONE


def test_r6_a_zone_is_the_union_of_strips_between_neighbouring_beams() -> None:
    found = told([("a", 1.0), ("door", 2.0), ("b", 3.0)], [("a", 1.0), ("door", 2.5), ("b", 4.0)])
    regions = {zone.label: zone.region for zone in found.zones}
    sine = math.sin(math.radians(20)) / 2
    assert regions["a"].area == pytest.approx(1 * sine)
    assert regions["b"].area == pytest.approx((3 * 4 - 2 * 2.5) * sine)


def test_r6_strips_join_what_overlaps_and_starts_alike() -> None:
    apart = told([("door", 1.0), ("b", 2.0)], [("door", 3.0), ("b", 4.0)])
    assert apart.zones == ()
    unlike = told([("b", 4.0)], [("door", 1.0), ("b", 4.0)])
    assert unlike.zones == ()
    others = told([("b", 4.0)], [("c", 4.0)])
    assert others.zones == ()


def test_r6_the_last_beam_and_the_first_are_neighbours() -> None:
    (zone,) = look(drawn("#aaa#\n#aaa#\n#aaa#"), (2.5, 1.5), sensor=Sensor(4, 1.0, 10)).zones
    assert zone.region.area == pytest.approx(2.0)


def test_r7_the_nearest_zone_is_here_and_ties_go_by_label() -> None:
    assert look(drawn(TWO_ROOMS), (2.53, 2.53)).here == "a"
    assert look(drawn(TWO_ROOMS), (3.3, 2.53)).here == "a"  # in the doorway, nearer to a
    assert look(drawn(TWO_ROOMS), (3.7, 2.53)).here == "b"
    one, other = [("z", 4.0)], [("c", 4.0)]
    tie = told(one, one, other, other)
    assert [zone.label for zone in tie.zones] == ["c", "z"]
    assert tie.here == "c"  # both regions hold the robot
    for threshold, here in ((1e-10, "a"), (1e-6, "z"), (0.5, "z")):
        behind = [("door", threshold), ("a", 2.0)]
        assert told([("z", 1.0)], [("z", 1.0)], behind, behind).here == here


@pytest.mark.parametrize("shift", [0.0, 1.0, 10.0, 100.3, -7.7])
def test_r7_rounding_does_not_decide_a_tie(shift: float) -> None:
    """Midway in a doorway both rooms begin at the same sample: a tie, wherever the world lies."""
    for left, right in (("a", "b"), ("b", "a")):
        world = World([
            WorldZone(left, Kind.SPACE, (shift, 0), (shift + 3, 3)),
            WorldZone("door", Kind.PASSAGE, (shift + 3, 0), (shift + 4, 3)),
            WorldZone(right, Kind.SPACE, (shift + 4, 0), (shift + 7, 3)),
        ])  # fmt: skip
        found = look(world, (shift + 3.5, 1.53), sensor=Sensor(72, 3.0, 10))
        apart = [zone.region.distance(shapely.Point(found.position)) for zone in found.zones]
        assert apart[0] == pytest.approx(apart[1], abs=1e-12)
        assert found.here == "a"


def test_r8_a_scan_without_zones_counts_and_changes_nothing() -> None:
    world = drawn(TWO_ROOMS)
    before = last(world, (2.5, 2.5)).state
    taken = step(before, scan_world(world, FINE, (90.0, 90.0)), SEEN)
    assert taken.here is None
    assert taken.events == ()
    assert taken.state.seq == before.seq + 1
    assert taken.state.graph is before.graph
    assert taken.state.metric.changed_since(before.metric) == []
    assert taken.state.metric.zones.keys() == before.metric.zones.keys()
    first = step(MapState(), scan_world(world, FINE, (90.0, 90.0)), SEEN)
    assert (first.here, first.state.seq, len(first.state.metric.zones)) == (None, 1, 0)


def test_r9_any_positive_area_is_a_zone_unless_asked_otherwise() -> None:
    beams = [("a", 2.0), ("door", 2.5), ("b", 2.75)]
    found = told(beams, beams)
    small, large = sorted(zone.region.area for zone in found.zones)
    assert 0 < small < large
    scan = scan_world(drawn(TWO_ROOMS), FINE, (2.53, 2.53))
    areas = {zone.label: zone.region.area for zone in extract(scan, SEEN).zones}
    for edges in Edges:
        limit = MappingOptions(edges=edges, min_zone_area=min(areas.values()))
        assert len(extract(scan, limit).zones) == 1  # the area must be above the limit
        assert extract(scan, limit).links == ()
        below = MappingOptions(edges=edges, min_zone_area=min(areas.values()) * 0.999)
        assert len(extract(scan, below).zones) == 2
    nothing = extract(scan, MappingOptions(min_zone_area=100.0))
    assert (nothing.zones, nothing.here, nothing.links) == ((), None, ())


@pytest.mark.parametrize("options", [SEEN, ADJACENT])
def test_r10_a_second_doorway_keeps_the_first_edge_and_its_point(options: MappingOptions) -> None:
    world, left, right = drawn(TWO_DOORS), (1.5, 3.5), (7.5, 3.5)
    first = last(world, left, options=options).state.graph.passages["a", "b", 0]
    both = last(world, left, (4.5, 3.5), right, options=options).state.graph.passages
    alone = last(world, right, options=options).state.graph.passages["a", "b", 0]
    assert both["a", "b", 0] == first
    assert first.point[0] < 2.0
    assert alone.point[0] > 7.0


def test_r11_the_point_is_the_nearest_of_the_zones_polygon() -> None:
    found = look(drawn(TWO_ROOMS), (2.03, 2.53))
    (link,) = found.links
    region = next(zone.region for zone in found.zones if zone.label == "b")
    point = shapely.Point(link.nearest_point(found.position))
    robot = shapely.Point(found.position)
    assert region.distance(point) < 1e-9
    assert robot.distance(point) == pytest.approx(robot.distance(region))
    vertices = shapely.get_coordinates(region)
    assert point.distance(robot) <= np.linalg.norm(vertices - (2.03, 2.53), axis=1).min() + 1e-9


def test_r12_fusion_is_union_with_holes_and_parts() -> None:
    round_: list[Point] = [
        (1.5, 1.5), (4.5, 1.5), (7.5, 1.5), (7.5, 4.5),
        (7.5, 7.5), (4.5, 7.5), (1.5, 7.5), (1.5, 4.5),
    ]  # fmt: skip
    ring = last(drawn(LOOP), *round_).state.metric.zones["c"].region
    assert isinstance(ring, Polygon)
    assert len(ring.interiors) == 1
    parts = last(drawn(LOOP), (1.5, 1.5), (7.5, 7.5)).state.metric.zones["c"].region
    regions = [
        next(zone.region for zone in look(drawn(LOOP), spot).zones if zone.label == "c")
        for spot in ((1.5, 1.5), (7.5, 7.5))
    ]
    assert parts.symmetric_difference(shapely.union_all(regions)).area < 1e-9


def test_r13_unknown_is_no_zone_no_passage_and_no_obstacle() -> None:
    beam = [("a", 1.0), ("fog", 2.0), ("b", 3.0)]
    found = told(beam, beam)
    assert [zone.label for zone in found.zones] == ["a", "b"]
    assert found.links == ()  # nobody knows whether one may pass
    zone = found.zones[0]
    xy, occupancy = zone.border.points()
    ends = np.linalg.norm(xy, axis=1)
    np.testing.assert_allclose(ends, 1.0)
    assert occupancy.tolist() == [FREE, FREE]


def test_r14_one_label_in_two_places_is_one_zone() -> None:
    world = drawn("#a#b#####a#")
    graph = last(world, (1.5, 0.5), (9.5, 0.5)).state
    assert list(graph.graph.nodes) == ["a"]
    region = graph.metric.zones["a"].region
    assert isinstance(region, MultiPolygon)
    assert len(region.geoms) == 2
    assert graph.metric.zones["a"].zone_id == "a"


def test_r15_seen_links_whatever_is_seen_from_here() -> None:
    assert pairs(look(drawn(THREE_IN_A_ROW), (2.53, 2.53), SEEN, Sensor(360, 8.0, 80))) == {
        "ab", "ac",
    }  # fmt: skip


def test_r15_adjacent_links_through_one_passage_from_the_zone_before_it() -> None:
    found = look(drawn(THREE_IN_A_ROW), (2.53, 2.53), ADJACENT, Sensor(360, 8.0, 80))
    assert pairs(found) == {"ab", "bc"}
    through_fog = told(*[[("a", 1.0), ("door", 1.2), ("fog", 1.4), ("b", 3.0)]] * 2)
    assert pairs(through_fog) == set()
    touching = told(*[[("a", 1.0), ("b", 3.0)]] * 2)
    assert pairs(touching) == {"ab"}
    from_a_doorway = told(*[[("door", 1.0), ("b", 3.0)]] * 2)
    assert pairs(from_a_doorway) == set()


def test_r15_an_adjacent_link_points_to_the_ground_that_is_entered() -> None:
    """`c` is seen through `b` from afar, and through its own door from nearby."""
    through = [("a", 1.0), ("door", 1.5), ("b", 2.0), ("door", 2.5), ("c", 4.0)]
    own = [("a", 0.5), ("door", 0.75), ("c", 3.0)]
    found = told(through, through, own, own)
    points = {
        link.source + link.target: math.hypot(*link.nearest_point((0.0, 0.0)))
        for link in found.links
    }
    chord = math.cos(math.radians(10))
    assert points == pytest.approx({"ab": 1.5 * chord, "bc": 2.5 * chord, "ac": 0.75 * chord})
