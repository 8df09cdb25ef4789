"""A large floor: 32 rooms along two corridors, with edges between neighbours only (R15)."""

from __future__ import annotations

from functools import cache

from shapely import MultiPolygon

from semtopo.mapper import Step, explore
from semtopo.sensor import Sensor
from semtopo.types import Edges, Kind, MappingOptions
from tests.plans import Floor

FLOOR = Floor()
SENSOR = Sensor(beams=72, range=4.0, samples=40)
HALLS = {"south", "north", "west", "east"}


@cache
def steps() -> list[Step]:
    """Return the drive through the whole floor."""
    return list(explore(FLOOR.world, SENSOR, FLOOR.path(), MappingOptions(edges=Edges.ADJACENT)))


def test_the_floor_is_as_told() -> None:
    spaces = {zone.label for zone in FLOOR.world.zones if zone.kind is Kind.SPACE}
    assert spaces == FLOOR.rooms.keys() | HALLS
    assert len(FLOOR.rooms) == 32
    assert len(FLOOR.doors) == 32 + 4
    assert len(FLOOR.path()) > 300


def test_every_room_is_found() -> None:
    state = steps()[-1].state
    assert len(state.graph.nodes) == len(state.metric.zones) == 36
    assert state.graph.nodes.keys() == FLOOR.rooms.keys() | HALLS


def test_every_door_is_two_edges_and_there_are_no_others() -> None:
    pairs = steps()[-1].state.graph.pairs
    assert len(pairs) == 2 * 36
    assert {frozenset(pair) for pair in pairs} == FLOOR.doors


def test_the_robot_has_been_in_every_zone() -> None:
    assert {taken.here for taken in steps()} == FLOOR.rooms.keys() | HALLS


def test_rooms_are_covered_and_no_larger_than_they_are() -> None:
    zones = steps()[-1].state.metric.zones
    full = Floor.ROOM**2
    assert all(0.85 * full < zones[room].region.area < full for room in FLOOR.rooms)


def test_regions_are_sound_after_a_long_drive() -> None:
    for zone in steps()[-1].state.metric.zones.values():
        assert zone.region.is_valid
        assert not isinstance(zone.region, MultiPolygon)


def test_the_papers_edges_link_what_lies_behind_two_doors() -> None:
    """So the option is worth having: already the first rooms are linked to each other."""
    *_, last = explore(FLOOR.world, SENSOR, FLOOR.path()[:80])
    pairs = {frozenset(pair) for pair in last.state.graph.pairs}
    assert pairs - FLOOR.doors
    assert pairs & FLOOR.doors
