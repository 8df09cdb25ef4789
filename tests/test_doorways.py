"""Doorways: the ground between zones, known like the zones themselves."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
import shapely
from hypothesis import given
from shapely import Polygon, box

from semtopo.crossings import DOORWAY_OVERLAP, pieces_of
from semtopo.doorways import DOORWAY_DEPTH, DOORWAY_REACH, Doorways
from semtopo.mapper import MapState, explore, run, scan_world, step
from semtopo.runs import LabelledRuns, from_runs
from semtopo.scan import Scan
from semtopo.sensor import Sensor
from semtopo.sensor_map import SensorMap, extract
from semtopo.types import Floats, Kind, MappingOptions, Pose
from tests.plans import THREE_IN_A_ROW, TWO_DOORS, TWO_ROOMS, drawn
from tests.strategies import Scene, labelled_runs, many, options, patient, poses, quick, scenes

FINE = Sensor(beams=360, range=8.0, samples=80)


def pieces(*parts: Polygon) -> Floats:
    """Return the corners of rectangles."""
    return np.array([part.exterior.coords[:-1] for part in parts])


def keys(doorways: Doorways) -> list[tuple[str, str, int]]:
    return list(doorways)


def scan_of(*beams: list[tuple[str, float]]) -> Scan:
    """Return the scan of labelled runs on beams 0.1 rad apart."""
    kinds = {"door": Kind.PASSAGE, "fog": Kind.UNKNOWN}
    seen = LabelledRuns(angle_min=0.0, angle_increment=0.1, range_max=4.0, beams=beams, kinds=kinds)
    return from_runs(Pose(0, 0), seen)


def grown(doorways: Doorways, one: str, other: str, corners: Floats, seq: int) -> Doorways:
    """Return the doorways with pieces seen between two zones."""
    return doorways.updated([((one, other), corners)], {}, seq)


def told(*beams: list[tuple[str, float]]) -> SensorMap:
    """Return the sensor map of labelled runs."""
    return extract(scan_of(*beams), MappingOptions())


def test_a_piece_lies_between_neighbouring_beams_that_both_cross() -> None:
    beam = [("a", 1.0), ("door", 2.0), ("b", 3.0)]
    (seen,) = told(beam, beam, [("a", 1.0)]).doorways
    assert (seen.source, seen.target) == (("a", 0), ("b", 0))
    (piece,) = pieces_of(seen.corners)
    near, far = 1.0 - DOORWAY_OVERLAP, 2.0 + DOORWAY_OVERLAP
    wanted = {(near, 0.0), (far, 0.0)} | {
        (radius * np.cos(0.1), radius * np.sin(0.1)) for radius in (near, far)
    }
    assert set(map(tuple, shapely.get_coordinates(piece).tolist())) == wanted
    (entered,) = seen.ground(np.array([True]))
    assert shapely.intersects(piece, entered)


@pytest.mark.parametrize(
    "other",
    [
        [("a", 1.0)],
        [("a", 1.0), ("door", 2.0)],
        [("a", 1.0), ("fog", 1.5), ("door", 2.0), ("b", 3.0)],
        [("c", 1.0), ("door", 2.0), ("b", 3.0)],
        [("a", 1.0), ("door", 2.0), ("c", 3.0)],
        [("door", 2.0), ("b", 3.0)],
        [],
    ],
)
def test_one_beam_alone_shows_no_doorway(other: list[tuple[str, float]]) -> None:
    assert told([("a", 1.0), ("door", 2.0), ("b", 3.0)], other).doorways == ()


def test_where_zones_touch_a_doorway_reaches_into_both() -> None:
    beam = [("a", 2.0), ("b", 4.0)]
    found = told(beam, beam)
    (seen,) = found.doorways
    one, other = (zone.region for zone in found.zones)
    (piece,) = pieces_of(seen.corners)
    for zone in (one, other):
        assert piece.intersection(zone).area == pytest.approx(piece.area / 2, rel=0.05)


def test_a_doorway_reaches_no_further_than_the_zones() -> None:
    beam = [("a", 0.02), ("door", 1.0), ("b", 1.03)]
    (seen,) = told(beam, beam).doorways
    reach = np.hypot(*seen.corners.reshape(-1, 2).T)
    assert reach.min() == 0.0
    assert reach.max() == pytest.approx(1.03)


def test_a_door_within_a_zone_is_a_doorway_from_it_to_itself() -> None:
    beam = [("a", 1.0), ("door", 1.5), ("a", 3.0)]
    (seen,) = told(beam, beam).doorways
    assert (seen.source, seen.target) == (("a", 0), ("a", 0))
    state = step(MapState(), scan_of(beam, beam), MappingOptions()).state
    assert list(state.metric.doorways) == [("a", "a", 0)]
    assert state.graph.pairs == ()
    ground = shapely.union_all(
        [state.metric.zones["a"].region, state.metric.doorways["a", "a", 0].region]
    )
    assert isinstance(ground, Polygon)


def test_new_pieces_make_doorways_with_numbers_of_their_own() -> None:
    doorways = grown(Doorways(), "b", "a", pieces(box(0, 0, 1, 1), box(5, 0, 6, 1)), 3)
    assert keys(doorways) == [("a", "b", 0), ("a", "b", 1)]
    assert {(door.since, door.seq) for door in doorways.values()} == {(3, 3)}
    other = grown(doorways, "a", "c", pieces(box(0, 0, 1, 1)), 4)
    assert keys(other) == [("a", "b", 0), ("a", "b", 1), ("a", "c", 0)]
    assert other.changed_since(doorways) == [other["a", "c", 0]]
    assert [door.number for door in other.between("b", "a")] == [0, 1]


def test_what_touches_a_known_doorway_is_part_of_it() -> None:
    first = grown(Doorways(), "a", "b", pieces(box(0, 0, 1, 1)), 1)
    second = grown(first, "b", "a", pieces(box(0.5, 0, 2, 1)), 2)
    (door,) = second.values()
    assert door.region.equals(box(0, 0, 2, 1))
    assert (door.since, door.seq) == (1, 2)
    assert first["a", "b", 0].region.equals(box(0, 0, 1, 1))


def test_what_adds_little_changes_nothing() -> None:
    doorways = grown(Doorways(), "a", "b", pieces(box(0, 0, 1, 1)), 1)
    assert grown(doorways, "a", "b", pieces(box(0, 0, 1, 1)), 2) is doorways
    assert grown(doorways, "a", "b", pieces(box(0.2, 0.2, 0.5, 1)), 2) is doorways
    sliver = DOORWAY_REACH / 2
    assert grown(doorways, "a", "b", pieces(box(0.5, 0, 1 + sliver, 1)), 2) is doorways
    assert grown(doorways, "a", "b", pieces(box(0.5, 0, 1 + 4 * sliver, 1)), 2) is not doorways
    two = grown(doorways, "a", "b", pieces(box(5, 0, 6, 1)), 2)
    assert grown(two, "a", "b", pieces(box(0.5, 0, 1 + sliver, 1)), 3) is two


def test_a_piece_may_reach_deeper_into_a_zone_than_the_doorway_does() -> None:
    """The sides of a piece from its corners 0 to 1, and 3 to 2, lead from zone to zone."""
    doorways = grown(Doorways(), "a", "b", pieces(box(0, 0, 1, 1)), 1)
    deeper = 1 + 0.75 * DOORWAY_DEPTH
    assert grown(doorways, "a", "b", pieces(box(0.5, 0, 1, deeper)), 2) is doorways
    too_deep = pieces(box(0.5, 0, 1, 1 + 1.5 * DOORWAY_DEPTH))
    assert grown(doorways, "a", "b", too_deep, 2) is not doorways


def test_what_changes_takes_in_all_that_is_seen() -> None:
    doorways = grown(Doorways(), "a", "b", pieces(box(0, 0, 1, 1)), 1)
    deeper, wider = box(0, 0, 1, 1.02), box(1, 0, 2, 1)
    (door,) = grown(doorways, "a", "b", pieces(deeper, wider), 2).values()
    assert door.region.equals(deeper.union(wider))


@quick
@given(scene=scenes())
def test_nothing_that_is_seen_is_far_from_a_doorway(scene: Scene) -> None:
    """What a scan shows of the way from zone to zone is a doorway then, but for a little."""
    for taken in explore(scene.world, scene.sensor, scene.walk):
        position = scene.walk[taken.state.seq - 1]
        found = extract(scan_world(scene.world, scene.sensor, position), MappingOptions())
        for seen in found.doorways:
            doors = taken.state.metric.doorways.between(seen.source[0], seen.target[0])
            known = shapely.union_all([door.region for door in doors])
            corners = shapely.points(seen.corners.reshape(-1, 2))
            assert shapely.distance(known, corners).max() < DOORWAY_DEPTH + 1e-9
            for piece in pieces_of(seen.corners):
                assert piece.difference(known).area < DOORWAY_DEPTH * piece.length


def test_parts_of_one_doorway_become_one_and_numbers_are_not_used_again() -> None:
    apart = grown(Doorways(), "a", "b", pieces(box(0, 0, 1, 1), box(3, 0, 4, 1)), 1)
    whole = grown(apart, "a", "b", pieces(box(0.5, 0, 3.5, 1)), 2)
    assert keys(whole) == [("a", "b", 0)]
    assert whole["a", "b", 0].region.equals(box(0, 0, 4, 1))
    assert dict(whole.former) == {("a", "b", 1): ("a", "b", 0)}
    later = grown(whole, "a", "b", pieces(box(9, 0, 10, 1)), 3)
    assert keys(later) == [("a", "b", 0), ("a", "b", 2)]


def test_pieces_that_touch_at_a_corner_are_one_doorway() -> None:
    """Also where a known one takes up one of them: nothing is found and gone in the same step."""
    known = grown(Doorways(), "a", "b", pieces(box(2, 2, 3, 3)), 1)
    whole = grown(known, "a", "b", pieces(box(0, 0, 1, 1), box(1, 1, 2.5, 2.5)), 2)
    assert keys(whole) == [("a", "b", 0)]
    assert dict(whole.former) == {}


def test_two_doors_are_two_doorways() -> None:
    walk = [(1.5, 3.5), (7.5, 3.5), (1.5, 1.5), (7.5, 1.5)]
    *_, last = explore(drawn(TWO_DOORS), FINE, walk)
    doorways = last.state.metric.doorways
    assert keys(doorways) == [("a", "b", 0), ("a", "b", 1)]
    for number, x in enumerate((1, 7)):
        door = doorways["a", "b", number].region
        assert isinstance(door, Polygon)
        assert box(x - 0.06, 1.8, x + 1.06, 3.2).covers(door)
        assert door.area > 0.8


def test_a_doorway_grows_with_what_is_seen_of_it() -> None:
    path = [(2.5, 2.5), (2.5, 3.2), (2.5, 1.8), (5.5, 2.5)]
    areas = [
        taken.state.metric.doorways["a", "b", 0].region.area
        for taken in explore(drawn(TWO_ROOMS), FINE, path)
    ]
    assert areas == sorted(areas)
    assert areas[0] < areas[-1]


def test_zones_and_doorways_are_one_free_space() -> None:
    *_, last = explore(drawn(THREE_IN_A_ROW), FINE, [(2.5, 2.5), (6.5, 2.5), (9.5, 2.5)])
    metric = last.state.metric
    assert keys(metric.doorways) == [("a", "b", 0), ("b", "c", 0)]
    zones = [zone.region for zone in metric.zones.values()]
    ground = shapely.union_all([*zones, *(door.region for door in metric.doorways.values())])
    assert isinstance(ground, Polygon)
    assert shapely.contains_properly(ground, shapely.LineString([(2.5, 2.5), (9.5, 2.5)]))
    free = shapely.union_all([
        shapely.box(*zone.low, *zone.high) for zone in drawn(THREE_IN_A_ROW).zones
        if zone.kind is not Kind.OBSTACLE
    ])  # fmt: skip
    assert ground.difference(free).area < 1e-9


@quick
@given(scene=scenes(), chosen=options)
def test_pieces_touch_the_zones_on_both_sides(scene: Scene, chosen: MappingOptions) -> None:
    for position in scene.walk:
        check_pieces(extract(scan_world(scene.world, scene.sensor, position), chosen))


@quick
@given(seen=labelled_runs(), pose=poses, chosen=options)
def test_pieces_from_runs_touch_the_zones_on_both_sides(
    seen: LabelledRuns, pose: Pose, chosen: MappingOptions
) -> None:
    check_pieces(extract(from_runs(pose, seen), chosen))


def check_pieces(found: SensorMap) -> None:
    """Every piece is sound, and shares ground or a side with both zones."""
    regions = {zone.name: zone.region for zone in found.zones}
    for seen in found.doorways:
        assert len(seen.corners) == len(seen.entered) > 0
        for piece in pieces_of(seen.corners):
            assert piece.is_valid
            for name in (seen.source, seen.target):
                assert piece.intersection(regions[name]).length > 0.01


@patient
@given(scene=scenes(), chosen=options)
def test_doorways_only_grow_and_never_touch(scene: Scene, chosen: MappingOptions) -> None:
    before = Doorways()
    for taken in explore(scene.world, scene.sensor, scene.walk, chosen):
        metric = taken.state.metric
        check_doorways(taken.state)
        for key, old in before.items():
            now = metric.doorways[current(metric.doorways, key)]
            assert old.region.difference(now.region).area < 1e-9
            assert now.since <= old.since
        before = metric.doorways


@patient
@given(seen=labelled_runs(), first=poses, second=poses, chosen=options)
def test_doorways_from_runs_never_touch(
    seen: LabelledRuns, first: Pose, second: Pose, chosen: MappingOptions
) -> None:
    for taken in run([from_runs(pose, seen) for pose in (first, second, first)], chosen):
        check_doorways(taken.state)


def current(doorways: Doorways, key: tuple[str, str, int]) -> tuple[str, str, int]:
    """Return the key of the doorway that has what once had this key."""
    while key in doorways.former:
        key = doorways.former[key]
    return key


def check_doorways(state: MapState) -> None:
    doorways = state.metric.doorways
    for key, door in doorways.items():
        assert key == door.key
        assert key not in doorways.former
        assert door.ends == tuple(sorted(door.ends))
        assert set(door.ends) <= state.metric.zones.keys()
        assert 1 <= door.since <= door.seq <= state.seq
        assert door.region.is_valid
        for zone_id in door.ends:
            assert door.region.distance(state.metric.zones[zone_id].region) < 1e-9
        for other in doorways.between(*door.ends):
            assert other is door or not other.region.intersects(door.region)


def test_scenes_show_doorways() -> None:
    """Of the drawn scenes most show a doorway, and some one that was seen in parts."""
    counts: Counter[str] = Counter()

    @many
    @given(scene=scenes())
    def count(scene: Scene) -> None:
        *_, last = explore(scene.world, scene.sensor, scene.walk)
        doorways = last.state.metric.doorways
        counts["all"] += 1
        counts["shown"] += len(doorways) > 0
        counts["parallel"] += any(key[2] > 0 for key in doorways)
        counts["joined"] += len(doorways.former) > 0

    count()
    assert counts["shown"] > 0.75 * counts["all"]
    assert counts["parallel"] > 0.25 * counts["all"]


def test_doorways_of_a_merged_zone_move_over() -> None:
    doorways = grown(Doorways(), "a", "c", pieces(box(0, 0, 1, 1)), 1)
    doorways = grown(doorways, "b", "c", pieces(box(0.5, 0, 2, 1), box(5, 0, 6, 1)), 2)
    doorways = grown(doorways, "a", "b", pieces(box(8, 0, 9, 1)), 3)
    after = doorways.updated([], {"b": "a"}, 4)
    assert list(after) == [("a", "c", 0), ("a", "c", 1), ("a", "a", 0)]
    assert after["a", "c", 0].region.equals(box(0, 0, 2, 1))
    assert after["a", "c", 1].region.equals(box(5, 0, 6, 1))
    assert (after["a", "c", 1].since, after["a", "c", 1].seq) == (2, 4)
    assert dict(after.former) == {
        ("b", "c", 0): ("a", "c", 0),
        ("b", "c", 1): ("a", "c", 1),
        ("a", "b", 0): ("a", "a", 0),
    }
    assert doorways.updated([], {"x": "y"}, 4) is doorways


def test_what_a_scan_shows_may_join_doorways_that_move() -> None:
    doorways = grown(Doorways(), "a", "c", pieces(box(0, 0, 1, 1)), 1)
    doorways = grown(doorways, "b", "c", pieces(box(3, 0, 4, 1)), 2)
    bridge = [(("c", "a"), pieces(box(0.5, 0, 3.5, 1)))]
    after = doorways.updated(bridge, {"b": "a"}, 3)
    assert list(after) == [("a", "c", 0)]
    assert after["a", "c", 0].region.equals(box(0, 0, 4, 1))
    assert after["a", "c", 0].since == 1
    assert dict(after.former) == {("b", "c", 0): ("a", "c", 0)}


def test_a_doorway_does_not_grow_with_every_step() -> None:
    """Along a walk of 200 new places before a door, it changes a few times, and stays simple."""
    walk = [(1.6 + number % 7 / 5, 1.5 + number / 110) for number in range(200)]
    changes = 0
    before = Doorways()
    for taken in explore(drawn(TWO_ROOMS), Sensor(72, 6.0, 60), walk):
        doorways = taken.state.metric.doorways
        changes += doorways is not before
        before = doorways
    assert 0 < changes < 50
    assert shapely.get_num_coordinates(before["a", "b", 0].region) < 350
