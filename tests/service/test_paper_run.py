"""The paper's run over HTTP is the run of the library, to the byte; and so are the files."""

from __future__ import annotations

import json
import subprocess
from functools import cache
from itertools import permutations
from pathlib import Path
from typing import Any

import pytest

from tests.servers import SEMTOPO, Backend, Server
from tests.service.twin import PAPER, Twin, paper_steps, paper_world, untimed

pytestmark = pytest.mark.databases("sqlite", "postgres")

BEAMS = [36, 72]
LOOKED_BACK = [0, 1, 5, 7, 29, 63, 64, 65, 66, 80, 81]
"""Among them both sides of the checkpoint after step 64."""


@cache
def library_run(beams: int) -> Twin:
    return Twin.driven({"world": paper_world(), "sensor": {"beams": beams}}, paper_steps())


@pytest.fixture(scope="module")
def runs(lasting_server: Server) -> dict[int, str]:
    """Drive the paper's path with both sensors, and give the sessions."""
    driven = {}
    for beams in BEAMS:
        path = lasting_server.create(**library_run(beams).session)
        answers = [lasting_server.step(path, document) for document in paper_steps()]
        assert [untimed(answer) for answer in answers] == library_run(beams).answers
        driven[beams] = path
    return driven


@pytest.mark.parametrize("beams", BEAMS)
def test_the_map_is_that_of_the_library(
    server: Server, runs: dict[int, str], beams: int
) -> None:  # fmt: skip
    path = runs[beams]
    assert server.get(f"{path}/zones") == library_run(beams).zones()
    assert server.get(f"{path}/graph") == library_run(beams).graph()


@pytest.mark.parametrize("beams", BEAMS)
@pytest.mark.parametrize("seq", LOOKED_BACK)
def test_earlier_maps_are_those_of_the_library(
    server: Server, runs: dict[int, str], beams: int, seq: int
) -> None:
    path = runs[beams]
    assert server.get(f"{path}/zones", at=seq) == library_run(beams).zones(seq)
    assert server.get(f"{path}/graph", at=seq) == library_run(beams).graph(seq)


def test_zones_in_a_box(server: Server, runs: dict[int, str]) -> None:
    whole = json.loads(library_run(72).zones())
    found = json.loads(server.get(f"{runs[72]}/zones", bbox="3,5.75,5,8"))
    room = [zone for zone in whole["features"] if zone["id"] == "A"]
    assert found == {**whole, "features": room}
    nothing = json.loads(server.get(f"{runs[72]}/zones", bbox="-9,-9,-8.5,-8"))
    assert nothing["features"] == []
    earlier = json.loads(server.get(f"{runs[72]}/zones", bbox="3,5.75,5,8", at=4))
    assert earlier["features"] == []


@pytest.mark.parametrize("beams", BEAMS)
def test_what_each_step_found_is_as_in_the_paper(
    server: Server, runs: dict[int, str], beams: int
) -> None:
    steps = json.loads(server.get(f"{runs[beams]}/steps"))["steps"]
    nodes = [(n, e["label"]) for n, e in findings(steps) if e["type"] == "node"]
    edges = [(n, e["source"], e["target"]) for n, e in findings(steps) if e["type"] == "edge"]
    assert nodes == [(1, "corridor"), (5, "A"), (29, "C"), (42, "B"), (74, "D")]
    assert edges == [
        (5, "corridor", "A"), (7, "A", "corridor"), (29, "C", "corridor"),
        (42, "corridor", "B"), (43, "B", "corridor"), (66, "corridor", "C"),
        (74, "corridor", "D"), (75, "D", "corridor"),
    ]  # fmt: skip
    assert steps[28]["answer"]["here"] == "C"


def findings(steps: list[dict[str, Any]]) -> list[tuple[int, dict[str, Any]]]:
    return [(step["seq"], event) for step in steps for event in step["answer"]["events"]]


def test_routes_follow_the_direction_of_edges(server: Server, runs: dict[int, str]) -> None:
    route = json.loads(server.get(f"{runs[72]}/route", **{"from": "A", "to": "c"}))
    assert route["zones"] == ["A", "corridor", "C"]
    assert route["length"] > 0
    asked = server.client.post(f"{runs[72]}/query", json={"text": "Path from A to C?"}).json()
    assert asked["route"] == route
    assert asked["kind"] == "path"
    assert asked["sentence"].startswith("Leave A at (")


def test_every_pair_of_zones_is_answered_in_the_end(server: Server, runs: dict[int, str]) -> None:
    path = runs[72]
    for source, target in permutations(("corridor", "A", "B", "C", "D"), 2):
        asked = {"from": source, "to": target, "radius": 0.2}
        route = json.loads(server.get(f"{path}/route", **asked))
        middle = [] if "corridor" in (source, target) else ["corridor"]
        assert route["zones"] == [source, *middle, target]
        assert route["path"]["clearance"] >= 0.2
        assert route["path"]["length"] == pytest.approx(route["length"], rel=0.15)
        assert route["path"]["points"][0] == pytest.approx(route["points"][0], abs=1e-3)
        assert route["path"]["points"][-1] == pytest.approx(route["points"][-1], abs=1e-3)


def test_a_passage_that_is_missing_is_named_until_it_is_found(
    server: Server, runs: dict[int, str]
) -> None:
    asked = {"from": "corridor", "to": "C"}
    for at in (29, 65):
        refused = server.client.get(f"{runs[72]}/route", params={**asked, "at": at})
        problem = refused.json()
        assert (refused.status_code, problem["code"]) == (409, "no_route")
        assert problem["missing"] == {"source": "corridor", "target": "C", "since": 29}
        assert "C" in problem["reaching"]
        assert {"corridor", "A"} <= set(problem["reachable"])
        assert problem["frontier"]["towards"] == "C"
    backwards = json.loads(server.get(f"{runs[72]}/route", **asked, at=29, two_way=True))
    assert backwards["zones"] == ["corridor", "C"]
    assert [it["backwards"] for it in backwards["passages"]] == [True]
    assert json.loads(server.get(f"{runs[72]}/route", **asked, at=66))["zones"] == ["corridor", "C"]


def test_routes_on_all_terms(server: Server, runs: dict[int, str]) -> None:
    path = runs[72]

    def route(**asked: Any) -> dict[str, Any]:  # noqa: ANN401 -- parameters
        params = {key.rstrip("_"): it for key, it in asked.items()}
        answer = server.client.get(f"{path}/route", params=params)
        return {**answer.json(), "http": answer.status_code}

    assert route(from_="A", to="B", via=["C", "D"])["zones"] == [
        "A", "corridor", "C", "corridor", "D", "corridor", "B",
    ]  # fmt: skip
    assert route(from_="A", to="B", avoid=["corridor"])["code"] == "no_route"
    assert route(from_="A", to="B", avoid=["A->corridor", "D"])["restricted"] is True
    assert route(from_="A", to="B", avoid="corridor->D")["zones"] == ["A", "corridor", "B"]
    assert route(from_="A", to="B", avoid="A->B")["code"] == "unknown_passage"
    assert route(from_="A", to="kitchen")["code"] == "unknown_zone"
    assert route(x=1.0, y=6.0, to="A")["points"][0] == [1.0, 6.0]
    assert route(x=1.0, y=6.0, to="A")["source"] == "corridor"
    assert route(x=-50, y=0, to="A")["code"] == "outside_free_space"
    assert route(from_="A", x=1.0, y=6.0, to="B")["code"] == "outside_free_space"
    assert route(x=1.0, to="A")["code"] == "invalid_request"
    assert route(from_="here", to="A")["source"] == "corridor"
    assert route(from_="A", to="B", passage_cost=10)["cost"] == pytest.approx(
        route(from_="A", to="B")["length"] + 20
    )
    assert route(from_="A", to="B", length_cost=0, passage_cost=1)["cost"] == 2
    assert route(from_="A", to="B", alternatives=3)["alternatives"] == []
    narrow = route(from_="A", to="B", radius=3)
    assert (narrow["http"], narrow["code"], narrow["needed"]) == (409, "too_narrow", 6)
    for wrong in ({"radius": -1}, {"alternatives": 0}, {"passage_cost": "nan"}, {"x": 1e9}):
        assert route(from_="A", to="B", **wrong)["code"] == "invalid_request", wrong


def test_edges_adjacent_is_passed_on(server: Server) -> None:
    session = {"world": paper_world(), "mapping": {"edges": "adjacent", "min_zone_area": 0.01}}
    path = server.create(**session)
    twin = Twin.driven(session, paper_steps()[:30])
    answers = [untimed(server.step(path, document)) for document in paper_steps()[:30]]
    assert answers == twin.answers
    assert server.get(f"{path}/graph") == twin.graph() != library_run(72).graph(30)
    assert server.get(f"{path}/zones") == twin.zones()


@pytest.mark.parametrize("beams", BEAMS)
def test_the_command_line_writes_the_same_bodies(
    server: Server, runs: dict[int, str], beams: int, tmp_path: Path
) -> None:
    files = [str(PAPER / "world.json"), str(PAPER / "path.csv")]
    command = [str(SEMTOPO), "map", *files, "--beams", str(beams), "--out", str(tmp_path)]
    subprocess.run(command, check=True, capture_output=True)
    assert (tmp_path / "zones.geojson").read_bytes() == server.get(f"{runs[beams]}/zones")
    assert (tmp_path / "graph.json").read_bytes() == server.get(f"{runs[beams]}/graph")
    lines = (tmp_path / "steps.jsonl").read_text().splitlines()
    assert [untimed(json.loads(line)) for line in lines] == library_run(beams).answers


def test_a_killed_server_goes_on_where_it_was(own_server: Server) -> None:
    own_server.start()
    twin = library_run(72)
    path = own_server.create(**twin.session)
    kills = {20, 64}
    for number, document in enumerate(paper_steps(), start=1):
        answer = own_server.step(path, {**document, "seq": number})
        assert untimed(answer) == twin.answers[number - 1]
        if number in kills:
            own_server.restart()
            assert json.loads(own_server.get(path))["seq"] == number
    assert own_server.get(f"{path}/zones") == twin.zones()
    assert own_server.get(f"{path}/graph") == twin.graph()
    assert own_server.get(f"{path}/zones", at=70) == twin.zones(70)


def test_a_server_that_is_asked_to_stop_leaves_one_file(
    own_server: Server, backend: Backend
) -> None:  # fmt: skip
    own_server.start()
    path = own_server.create(**library_run(72).session)
    answer = own_server.step(path, paper_steps()[0])
    own_server.stop()
    if backend == "sqlite":
        assert [file.name for file in own_server.database.parent.iterdir()] == ["semtopo.db"]
    own_server.start()
    assert json.loads(own_server.get(f"{path}/steps"))["steps"][0]["answer"] == answer
