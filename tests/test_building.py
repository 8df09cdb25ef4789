"""A real robot in a real building: Freiburg 079, with edges between neighbours only (R15).

The recording may not be copied into the repository; without the folder beside it that holds it,
these tests are skipped.
"""

from __future__ import annotations

import gzip
import json
import math
from collections.abc import Iterator
from functools import cache
from itertools import pairwise, permutations
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import pytest
import shapely

from semtopo.answers import answer
from semtopo.answers.values import PathAnswer
from semtopo.atlas import Atlas
from semtopo.errors.ways import NoRouteError, TooNarrowError
from semtopo.geometry import joined
from semtopo.ground import Ground, ground_of
from semtopo.journey import WayOptions
from semtopo.mapper import Step, run
from semtopo.route import Place, Route, RouteRequest, find_routes
from semtopo.runs import LabelledRuns, from_runs
from semtopo.scan import Scan
from semtopo.types import Edges, Identity, Kind, MappingOptions, Passages, Point, Pose

SCANS = Path(__file__).parents[2] / "shared" / "data" / "freiburg079" / "scans.jsonl.gz"

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(
        not SCANS.exists(), reason=f"{SCANS} is not at hand: no real building was mapped"
    ),
]

DRIVEN = [("corridor", f"room-{n}") for n in (8, 11, 14, 7, 4)] + [("room-8", "room-6")]
DOORS = {frozenset(("corridor", f"room-{n}")) for n in range(2, 16)} | {
    frozenset(("room-5", "room-9")),
    frozenset(("room-6", "room-8")),
    frozenset(("room-6", "room-15")),
}


def recorded() -> Iterator[tuple[Pose, Scan]]:
    """Yield the poses of the drive, and what was seen from them."""
    with gzip.open(SCANS, "rt") as lines:
        for told in map(json.loads, lines):
            pose, seen = Pose(**told["pose"]), told["scan"]
            kinds = {label: Kind[kind.upper()] for label, kind in seen.pop("kinds").items()}
            yield pose, from_runs(pose, LabelledRuns(**seen, kinds=kinds))


@cache
def drive() -> tuple[list[Pose], list[Step]]:
    """Return the poses of the drive, and the steps of the mapper."""
    poses, scans = zip(*recorded(), strict=True)
    return list(poses), list(run(scans, MappingOptions(edges=Edges.ADJACENT)))


def passages() -> dict[tuple[str, str], Point]:
    """Return the point of each passage that was found."""
    _, steps = drive()
    return {(a, b): passage.point for (a, b, _), passage in steps[-1].state.graph.passages.items()}


def openings(one: str, other: str) -> list[Point]:
    """Return where the robot drove from one zone into the other, either way."""
    poses, steps = drive()
    return [
        ((first.x + second.x) / 2, (first.y + second.y) / 2)
        for (first, before), (second, after) in pairwise(zip(poses, steps, strict=True))
        if {before.here, after.here} == {one, other}
    ]


def test_every_room_is_found() -> None:
    _, steps = drive()
    rooms = {f"room-{n}" for n in range(2, 16)}
    assert steps[-1].state.graph.nodes.keys() == {"corridor", *rooms}
    assert len(steps) == 650


@pytest.mark.parametrize(("one", "other"), DRIVEN)
def test_a_driven_door_is_an_edge_both_ways(one: str, other: str) -> None:
    assert {(one, other), (other, one)} <= passages().keys()


def test_no_edge_where_there_is_no_door() -> None:
    assert {frozenset(pair) for pair in passages()} <= DOORS


@pytest.mark.parametrize(("one", "other"), DRIVEN)
def test_the_robot_drove_through_there_and_back(one: str, other: str) -> None:
    assert len(openings(one, other)) == 2
    assert math.dist(*openings(one, other)) < 1.5


@pytest.mark.parametrize(("one", "other"), [*DRIVEN, *((b, a) for a, b in DRIVEN)])
def test_the_point_of_a_driven_door_lies_where_the_robot_drove(one: str, other: str) -> None:
    point = passages()[one, other]
    assert min(math.dist(point, opening) for opening in openings(one, other)) < 1.0


def test_the_map_is_sound_at_the_end_of_a_long_drive() -> None:
    _, steps = drive()
    state = steps[-1].state
    assert list(state.metric.zones) == list(state.graph.nodes)
    for zone in state.metric.zones.values():
        assert zone.region.is_valid
        assert zone.region.area > 0


def test_places_of_a_label_and_all_doors_make_the_same_building() -> None:
    """With glimpses below half a square metre left out, each room is one zone again."""
    chosen = MappingOptions(
        edges=Edges.ADJACENT, passages=Passages.ALL, identity=Identity.INSTANCE, min_zone_area=0.5
    )
    *_, last = run([scan for _, scan in recorded()], chosen)
    graph = last.state.graph
    assert set(graph.nodes) == {"corridor", *(f"room-{number}" for number in range(2, 16))}
    assert all(frozenset(pair) in DOORS for pair in graph.pairs)
    driven = {pair for a, b in DRIVEN for pair in ((a, b), (b, a))}
    # through the door of room-14 no scan showed half a square metre of corridor
    assert driven - set(graph.pairs) == {("room-14", "corridor")}
    assert {frozenset(key[:2]) for key in last.state.metric.doorways if key[0] != key[1]} <= DOORS


def asked(**more: Any) -> tuple[Route, ...]:  # noqa: ANN401 -- as RouteRequest takes it
    atlas = Atlas(drive()[1][-1].state)
    return find_routes(
        atlas, RouteRequest(start=Place("room-6"), goals=(Place("room-14"),), **more)
    )


def test_the_way_from_room_to_room() -> None:
    (route,) = asked(radius=0.15)
    assert route.zones == ("room-6", "corridor", "room-14")
    assert route.path is not None
    assert route.path.clearance >= 0.15
    line = shapely.LineString(route.path.points)
    metric = drive()[1][-1].state.metric
    regions = [metric.zones[zone].region for zone in route.zones]
    regions += [door.region for door in metric.doorways.values()]
    assert joined(np.array(regions, dtype=np.object_)).buffer(1e-6).covers(line)
    assert 5 < route.path.length <= route.length + 1


def test_a_door_that_was_not_seen_wide_enough_is_named() -> None:
    """The robot never drove from room-6 into the corridor, and saw little of that door."""
    with pytest.raises(TooNarrowError) as caught:
        asked(radius=0.25, avoid_zones=frozenset({"room-8"}))
    assert caught.value.needed == 0.5
    assert 0.3 < caught.value.width < 0.5
    assert math.dist(caught.value.point, passages()["room-6", "corridor"]) < 0.5


def test_a_wide_robot_takes_the_way_on_which_it_fits() -> None:
    """The real robot drove through these three doors."""
    (route,) = asked(radius=0.25)
    assert route.zones == ("room-6", "room-8", "corridor", "room-14")
    assert route.path is not None
    assert route.path.clearance >= 0.25
    assert 15 < route.path.length < 25


def test_the_way_around_what_is_avoided() -> None:
    (direct,) = asked()
    (around,) = asked(avoid_passages=frozenset({("room-6", "corridor", 0)}))
    assert around.zones == ("room-6", "room-8", "corridor", "room-14")
    assert around.length > direct.length
    avoiding = frozenset({"room-8"})
    assert asked(avoid_zones=avoiding)[0] == direct
    with pytest.raises(NoRouteError) as caught:
        asked(avoid_zones=frozenset({"corridor"}))
    assert caught.value.restricted


def test_lengths_in_windows_are_those_in_the_whole_corridor() -> None:
    state = drive()[1][-1].state
    ground = ground_of(state.metric, "corridor")
    whole = Ground(ground.zone, ground.doorways)
    whole._spent = whole.size
    points = [it.point for it in state.graph.passages.values() if "corridor" in it.key]
    bent = 0
    for start, end in Random(0).sample(list(permutations(points, 2)), 60):
        alone = Ground(ground.zone, ground.doorways)
        length = alone.length(start, end)
        assert length == pytest.approx(whole.length(start, end), abs=1e-9)
        bent += length > math.dist(start, end)
        assert alone._spent < 2 * alone.size
    assert bent > 30


def test_a_room_that_was_only_looked_into_says_so() -> None:
    with pytest.raises(NoRouteError, match="room-12 was only looked into, from corridor") as caught:
        answer(Atlas(drive()[1][-1].state), "path from room-12 to room-2")
    assert caught.value.two_way
    assert caught.value.missing is not None
    assert "With two_way" in str(caught.value)
    both = WayOptions(two_way=True)
    found = answer(Atlas(drive()[1][-1].state), "path from room-12 to room-2", options=both)
    assert isinstance(found, PathAnswer)
    assert found.route.zones == ("room-12", "corridor", "room-2")
    assert [it.source for it in found.route.backwards] == ["corridor"]
