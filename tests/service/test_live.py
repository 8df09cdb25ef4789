"""Where the robot was and what it saw: trail, scan and world."""

from __future__ import annotations

import json

import numpy as np
import pytest

from semtopo.mapper import scan_world
from semtopo.runs import LabelledRuns, from_runs
from semtopo.sensor import Sensor
from semtopo.types import Kind, Occupancy, Pose
from semtopo.world import World, WorldZone
from tests.servers import Json, Server
from tests.service.twin import at, paper_steps, paper_world, scan_json

pytestmark = pytest.mark.databases("sqlite", "postgres")

SESSION: Json = {"world": paper_world(), "sensor": {"beams": 36}}
STEPS = paper_steps()


def read(server: Server, path: str, **query: object) -> Json:
    body: Json = json.loads(server.get(path, **query))
    return body


def test_the_trail_tells_poses_and_findings(server: Server) -> None:
    path = server.create(**SESSION)
    answers = [server.step(path, step) for step in STEPS]
    trail = read(server, f"{path}/trail")
    assert trail["first"] == 1
    assert trail["next"] is None
    assert trail["poses"] == [[*step["pose"].values()] for step in STEPS]
    found = [answer for answer in answers if answer["events"]]
    assert {1, 5, 7, 29, 66} <= {one["seq"] for one in found}
    assert len(found) < len(STEPS) / 2
    assert trail["changes"] == [
        {key: one[key] for key in ("seq", "here", "events")} for one in found
    ]


def test_the_trail_comes_in_pages(server: Server) -> None:
    path = server.create(**SESSION)
    for step in STEPS[:7]:
        server.step(path, step)
    whole = read(server, f"{path}/trail")
    pages = [read(server, f"{path}/trail", after=after, limit=3) for after in (0, 3, 6)]
    assert [page["next"] for page in pages] == [3, 6, None]
    assert [page["first"] for page in pages] == [1, 4, 7]
    for part in ("poses", "changes"):
        assert [one for page in pages for one in page[part]] == whole[part]
    assert read(server, f"{path}/trail", after=7)["poses"] == []


def test_the_trail_tells_poses_of_steps_with_scans_exactly(server: Server) -> None:
    path = server.create()
    scan = {"angle_min": 0.0, "angle_increment": 1.0, "range_max": 2.0, "kinds": {}}
    pose = (-123456.78901234567, 1e-300, -0.1)
    server.step(path, at(*pose, {**scan, "beams": [[["}" * 50, 1.0]]] * 6}))
    assert read(server, f"{path}/trail")["poses"] == [list(pose)]


def test_a_scan_of_a_world_is_what_the_library_sees(server: Server) -> None:
    path = server.create(**SESSION)
    for step in STEPS[:6]:
        server.step(path, step)
    zones = [
        WorldZone(
            zone["label"], Kind[zone["kind"].upper()], tuple(zone["low"]), tuple(zone["high"])
        )
        for zone in paper_world()["zones"]
    ]
    pose = STEPS[3]["pose"]
    seen = scan_world(World(zones), Sensor(beams=36, range=2.0, samples=20), (pose["x"], pose["y"]))
    ends, occupancy = seen.ends()
    body = read(server, f"{path}/scan", at=4)
    assert body["pose"] == pose
    assert body["seq"] == 4
    assert body["ends"] == ends.tolist()
    assert body["occupancy"] == [Occupancy(it).name.lower() for it in occupancy.tolist()]
    assert len(set(body["occupancy"])) > 1
    newest = server.client.get(f"{path}/scan")
    assert newest.json() == read(server, f"{path}/scan", at=6)
    known = {"If-None-Match": newest.headers["ETag"]}
    assert server.client.get(f"{path}/scan", headers=known).status_code == 304


def test_a_scan_that_was_sent_is_read_back(server: Server) -> None:
    path = server.create()
    seen = LabelledRuns(
        angle_min=-1.0, angle_increment=0.5, range_max=5.0, kinds={"wall": Kind.OBSTACLE},
        beams=[
            [("hall", 2.0), ("wall", 2.1)], [("hall", 5.0)], [], [("hall", 1.0)], [("hall", 3.0)],
        ],
    )  # fmt: skip
    server.step(path, at(1, 2, 0.5, scan_json(seen)))
    ends, _ = from_runs(Pose(1, 2, 0.5), seen).ends()
    body = read(server, f"{path}/scan")
    assert body["ends"] == ends.tolist()
    assert body["occupancy"] == ["obstacle", "free", "none", "obstacle", "obstacle"]
    assert np.allclose(np.hypot(*(ends - [1, 2]).T), [2, 5, 0, 1, 3])


def test_before_the_first_step_nothing_was_seen(server: Server) -> None:
    path = server.create(**SESSION)
    assert read(server, f"{path}/scan") == {"seq": 0, "pose": None, "ends": [], "occupancy": []}
    assert read(server, f"{path}/trail")["poses"] == []
    missing = server.client.get(f"{path}/scan", params={"at": 1})
    assert (missing.status_code, missing.json()["code"]) == (404, "unknown_step")


def test_the_world_can_be_read(server: Server) -> None:
    path = server.create(**SESSION)
    assert read(server, f"{path}/world")["zones"] == paper_world()["zones"]
    without = server.client.get(f"{server.create()}/world")
    assert (without.status_code, without.json()["code"]) == (409, "no_world")
