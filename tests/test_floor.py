"""A large floor: 32 rooms along two corridors, with edges between neighbours only (R15)."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from itertools import pairwise

import pytest
from shapely import MultiPolygon

from semtopo.graph import NodeMerged
from semtopo.mapper import Step, explore
from semtopo.sensor import Sensor
from semtopo.types import Edges, Identity, Kind, MappingOptions, Passages
from semtopo.world import World
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


@cache
def offices() -> list[Step]:
    """Return the drive through the floor where every room is an `office`, each a zone."""
    zones = [
        replace(zone, label="office" if zone.label in FLOOR.rooms else zone.label)
        for zone in FLOOR.world.zones
    ]
    chosen = MappingOptions(edges=Edges.ADJACENT, passages=Passages.ALL, identity=Identity.INSTANCE)
    return list(explore(World(zones), SENSOR, FLOOR.path(), chosen))


def test_rooms_of_one_name_are_told_apart() -> None:
    """In the end each office is one zone, joined to the hall that its namesake room has."""
    state = offices()[-1].state
    found = [zone for zone in state.metric.zones.values() if zone.label == "office"]
    named = steps()[-1].state.metric.zones
    assert len(state.metric.zones) == 32 + 4
    assert len({zone.zone_id for zone in found}) == 32
    for room, hall in FLOOR.rooms.items():
        (mine,) = [zone for zone in found if zone.region.intersects(named[room].region)]
        assert mine.region.area == pytest.approx(named[room].region.area, abs=1e-6)
        assert {(mine.zone_id, hall, 0), (hall, mine.zone_id, 0)} <= state.graph.passages.keys()
    assert len(state.graph.passages) == 2 * 36
    assert len(state.metric.doorways) == 36


def test_rooms_of_one_name_merge_where_they_were_seen_in_parts() -> None:
    merges = [one for taken in offices() for one in taken.events if isinstance(one, NodeMerged)]
    assert {one.zone_id: one.into for one in merges} == offices()[-1].state.metric.former
    for before, taken in pairwise(offices()):
        assert offices()[-1].state.graph.at(before.state.seq).pairs == before.state.graph.pairs
        assert taken.here == taken.state.metric.zones[taken.state.here or ""].label
