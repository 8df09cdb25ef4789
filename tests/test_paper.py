"""The paper's scenario (section 3) and its claims, one test per sentence.

The world and the path are the project's own (the paper prints neither), laid out so that the
events fall where section 3 says. The claims are told here; `expected.json`, made by an
independent implementation, adds areas and points where the folder shared with it is at hand.
"""

from __future__ import annotations

import csv
import json
import math
from functools import cache
from pathlib import Path
from typing import Any

import pytest
import shapely
from shapely import Point as Place
from shapely import Polygon

from semtopo.graph import NodeFound, PassageFound
from semtopo.mapper import Step, explore
from semtopo.sensor import Sensor
from semtopo.types import Edges, Kind, MappingOptions, Occupancy, Point
from semtopo.world import World, WorldZone
from tests import oracle
from tests.test_mapper import check_step

ROOT = Path(__file__).parents[1]
EXAMPLE = ROOT / "examples" / "paper"
EXPECTED = ROOT.parent / "shared" / "scenarios" / "paper" / "expected.json"

BEAMS = [36, 72, 360]
ROOMS = {"A", "B", "C", "D"}

EVENTS = [
    (1, "corridor", "corridor"),
    (5, "corridor", "A"),
    (5, "corridor", ("corridor", "A")),
    (7, "A", ("A", "corridor")),
    (29, "C", "C"),
    (29, "C", ("C", "corridor")),
    (42, "corridor", "B"),
    (42, "corridor", ("corridor", "B")),
    (43, "B", ("B", "corridor")),
    (66, "corridor", ("corridor", "C")),
    (74, "corridor", "D"),
    (74, "corridor", ("corridor", "D")),
    (75, "D", ("D", "corridor")),
]
"""Step, where the robot is, and the label or the pair of labels that was found."""


@cache
def world() -> World:
    """Return the paper's world."""
    told = json.loads((EXAMPLE / "world.json").read_text())
    return World([
        WorldZone(z["label"], Kind[z["kind"].upper()], tuple(z["low"]), tuple(z["high"]))
        for z in told["zones"]
    ])  # fmt: skip


@cache
def path() -> list[Point]:
    """Return the paper's path."""
    with (EXAMPLE / "path.csv").open(newline="") as lines:
        return [(float(row["x"]), float(row["y"])) for row in csv.DictReader(lines)]


@cache
def steps(beams: int, edges: Edges = Edges.SEEN) -> list[Step]:
    """Return the run with some number of beams; range and quantum are the paper's."""
    options = MappingOptions(edges=edges)
    return list(explore(world(), Sensor(beams, 2.0, 20), path(), options))


@cache
def expected() -> Any:  # noqa: ANN401 -- JSON
    """Return what the independent implementation found."""
    if not EXPECTED.exists():
        pytest.skip(f"{EXPECTED} is not at hand: areas and points are not compared")
    return json.loads(EXPECTED.read_text())


def step(number: int, beams: int) -> Step:
    """Return a step by the paper's number."""
    return steps(beams)[number - 1]


def events(found: list[Step]) -> list[tuple[int, str | None, str | tuple[str, str]]]:
    """Return all events as in EVENTS."""
    return [
        (number, taken.here, e.label if isinstance(e, NodeFound) else (e.source, e.target))
        for number, taken in enumerate(found, start=1)
        for e in taken.events
        if isinstance(e, NodeFound | PassageFound)
    ]


def holes(region: object) -> int:
    """Return how many holes a region has; one in several parts has none that counts."""
    return len(region.interiors) if isinstance(region, Polygon) else -1


def near_door(point: Point, low: Point, high: Point) -> bool:
    """Say whether a point lies in a doorway, or within 0.15 m of it."""
    return all(a - 0.15 <= p <= b + 0.15 for p, a, b in zip(point, low, high, strict=True))


def test_a_corridor_loop_with_four_neighbouring_rooms() -> None:
    spaces = {zone.label for zone in world().zones if zone.kind is Kind.SPACE}
    assert spaces == {"corridor", *ROOMS}


def test_the_robot_starts_at_1_6_and_takes_81_steps() -> None:
    assert path()[0] == (1, 6)
    assert len(path()) == 81


@pytest.mark.parametrize("beams", BEAMS)
def test_every_event_at_its_step(beams: int) -> None:
    assert events(steps(beams)) == EVENTS


@pytest.mark.parametrize("beams", BEAMS)
def test_in_step_one_the_first_node_is_the_corridor(beams: int) -> None:
    state = step(1, beams).state
    assert list(state.graph.nodes) == list(state.metric.zones) == ["corridor"]
    assert not state.graph.passages


@pytest.mark.parametrize("beams", BEAMS)
def test_step_one_is_made_from_the_measurement_of_the_first_position(beams: int) -> None:
    region = step(1, beams).state.metric.zones["corridor"].region
    assert region.contains(Place(1, 6))
    assert region.hausdorff_distance(Place(1, 6)) == pytest.approx(2.0, abs=0.11)


@pytest.mark.parametrize("beams", BEAMS)
def test_the_following_steps_expand_the_corridor(beams: int) -> None:
    areas = [step(n, beams).state.metric.zones["corridor"].region.area for n in range(1, 5)]
    assert areas == sorted(set(areas))
    assert not any(step(n, beams).events for n in range(2, 5))


@pytest.mark.parametrize("beams", BEAMS)
def test_in_step_five_zone_a_is_found_from_the_corridor(beams: int) -> None:
    state = step(5, beams).state
    assert list(state.graph.nodes) == ["corridor", "A"]
    assert state.graph.pairs == (("corridor", "A"),)


@pytest.mark.parametrize("beams", BEAMS)
def test_the_new_edge_memorises_the_nearest_passage_point(beams: int) -> None:
    taken = step(5, beams)
    passage = taken.state.graph.passages["corridor", "A", 0]
    region, robot = taken.state.metric.zones["A"].region, Place(path()[4])
    assert passage.seq == 5
    assert robot.distance(Place(passage.point)) == pytest.approx(robot.distance(region))
    assert near_door(passage.point, (2, 6.5), (3, 7.5))


@pytest.mark.parametrize("beams", BEAMS)
def test_at_step_seven_the_robot_is_closer_to_a_and_the_edge_back_is_made(beams: int) -> None:
    assert step(6, beams).here == "corridor"
    assert step(7, beams).here == "A"
    assert ("A", "corridor") not in step(6, beams).state.graph.pairs
    assert ("A", "corridor") in step(7, beams).state.graph.pairs


@pytest.mark.parametrize("beams", BEAMS)
def test_at_step_29_the_robot_is_in_c_without_an_edge_from_the_corridor(beams: int) -> None:
    taken = step(29, beams)
    assert taken.here == "C"
    assert "C" not in step(28, beams).state.graph.nodes
    assert ("C", "corridor") in taken.state.graph.pairs
    assert ("corridor", "C") not in taken.state.graph.pairs


@pytest.mark.parametrize("beams", BEAMS)
def test_at_step_66_the_misdetection_is_corrected(beams: int) -> None:
    assert ("corridor", "C") not in step(65, beams).state.graph.pairs
    assert ("corridor", "C") in step(66, beams).state.graph.pairs


@pytest.mark.parametrize("beams", BEAMS)
def test_at_step_81_the_corridor_is_a_ring_with_one_hole(beams: int) -> None:
    zones = step(81, beams).state.metric.zones
    assert {label: holes(zone.region) for label, zone in zones.items()} == {
        "corridor": 1, "A": 0, "B": 0, "C": 0, "D": 0,
    }  # fmt: skip


@pytest.mark.parametrize("beams", BEAMS)
def test_at_step_81_every_room_is_linked_to_the_corridor_both_ways(beams: int) -> None:
    pairs = {("corridor", room) for room in ROOMS} | {(room, "corridor") for room in ROOMS}
    assert set(step(81, beams).state.graph.pairs) == pairs


@pytest.mark.parametrize("beams", BEAMS)
def test_every_passage_point_lies_at_its_door(beams: int) -> None:
    doors = {
        "A": ((2, 6.5), (3, 7.5)), "B": ((7.1, 8), (8.1, 9)),
        "C": ((9, 3.6), (10, 4.6)), "D": ((3.9, 2), (4.9, 3)),
    }  # fmt: skip
    for (source, target, _), passage in step(81, beams).state.graph.passages.items():
        (room,) = {source, target} - {"corridor"}
        assert near_door(passage.point, *doors[room])


@pytest.mark.parametrize("beams", BEAMS)
def test_the_model_covers_the_spaces_and_little_else(beams: int) -> None:
    truth = {"corridor": 12 * 11 - 8 * 7, **dict.fromkeys(ROOMS, 2.75 * 2.25)}
    for label, zone in step(81, beams).state.metric.zones.items():
        assert 0.93 * truth[label] < zone.region.area < truth[label]


@pytest.mark.parametrize("beams", BEAMS)
def test_the_robot_never_leaves_the_map(beams: int) -> None:
    assert all(taken.here in taken.state.metric.zones for taken in steps(beams))


def test_the_run_equals_the_literal_algorithms() -> None:
    scans = [oracle.analyse(world(), Sensor(36, 2.0, 20), position) for position in path()]
    wanted = oracle.run(scans, MappingOptions())
    for position, one, two in zip(path(), wanted, steps(36), strict=True):
        check_step(one, two, position)


@pytest.mark.parametrize("beams", BEAMS)
def test_events_equal_the_expected(beams: int) -> None:
    wanted = [
        (e["step"], e["here"], tuple(e["edge"]) if "edge" in e else e["node"])
        for e in expected()["events"]
    ]
    assert events(steps(beams)) == wanted == EVENTS


@pytest.mark.parametrize("beams", BEAMS)
def test_areas_are_within_one_percent_of_the_expected(beams: int) -> None:
    wanted = expected()["areas_m2"][str(beams)]
    zones = step(81, beams).state.metric.zones
    assert {label: zone.region.area for label, zone in zones.items()} == pytest.approx(
        wanted, rel=0.01
    )


@pytest.mark.parametrize("beams", BEAMS)
def test_passage_points_are_within_15_cm_of_the_expected(beams: int) -> None:
    wanted = expected()["passage_points"][str(beams)]
    found = {f"{s}->{t}": p.point for (s, t, _), p in step(81, beams).state.graph.passages.items()}
    assert found.keys() == wanted.keys()
    assert {name: math.dist(point, wanted[name]) for name, point in found.items()} == (
        pytest.approx(dict.fromkeys(wanted, 0.0), abs=0.15)
    )


@pytest.mark.parametrize("beams", BEAMS)
def test_adjacent_edges_are_doors_of_the_corridor_too(beams: int) -> None:
    found = steps(beams, Edges.ADJACENT)[-1].state.graph.passages
    assert found.keys() == step(81, beams).state.graph.passages.keys()


def test_passages_come_with_their_step() -> None:
    told = {
        (e.source, e.target): number
        for number, taken in enumerate(steps(72), start=1)
        for e in taken.events
        if isinstance(e, PassageFound)
    }
    found = {(s, t): p.seq for (s, t, _), p in step(81, 72).state.graph.passages.items()}
    assert found == told


def test_border_points_equal_the_literal_ones() -> None:
    """They are the characteristic points of all scans that are vertices of the zone in the end."""
    sensor = Sensor(36, 2.0, 20)
    claims: dict[str, dict[Point, Occupancy]] = {}
    for position in path():
        scan = oracle.analyse(world(), sensor, position)
        for beam, pieces in enumerate(scan.beams):
            for piece in pieces:
                mine = claims.setdefault(piece.label, {})
                ends = ((piece.near, piece.near_occupancy), (piece.far, piece.far_occupancy))
                for radius, why in ends:
                    place = rounded(*scan.at(beam, radius))
                    mine[place] = max(mine.get(place, Occupancy.NONE), why)
    for label, zone in step(len(path()), 36).state.metric.zones.items():
        vertices = {rounded(x, y) for x, y in shapely.get_coordinates(zone.region).tolist()}
        wanted = {it: why for it, why in claims[label].items() if it in vertices and why}
        xy, occupancy = zone.border.points()
        places = [rounded(x, y) for x, y in xy.tolist()]
        assert len(places) > 10
        assert dict(zip(places, occupancy.tolist(), strict=True)) == wanted


def rounded(x: float, y: float) -> Point:
    """Return a point without what rounding does to it."""
    return (round(x, 9) + 0.0, round(y, 9) + 0.0)
