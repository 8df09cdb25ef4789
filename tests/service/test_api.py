"""Every call of the interface: what goes in, what comes out, and what is gone after a deletion."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator

import httpx2
import pytest
from pydantic import BaseModel

from semtopo.documents import MappingDocument, WorldDocument
from service.schemas.answers import RouteAnswer
from service.schemas.live import SightAnswer, TrailAnswer
from service.schemas.maps import BordersAnswer, DoorwaysAnswer, GraphAnswer, ZonesAnswer
from service.schemas.operations import HealthAnswer
from service.schemas.problems import ProblemAnswer
from service.schemas.sessions import SessionAnswer, SessionsAnswer
from service.schemas.steps import StepAnswer, StepsAnswer
from tests.servers import Json, Server
from tests.service.twin import at, paper_steps, paper_world

pytestmark = pytest.mark.databases("sqlite", "postgres")

PROBLEM = "application/problem+json"
GEOJSON = "application/geo+json"
ROOM_SCAN: Json = {
    "angle_min": 0.0,
    "angle_increment": 1.5,
    "range_max": 4.0,
    "beams": [[["hall", 1.0], ["door", 1.2], ["room", 3.0]]] * 4,
    "kinds": {"door": "passage"},
}


@pytest.fixture(scope="module")
def session(lasting_server: Server) -> str:
    """Give a session that has come as far as room A and back, so that it has a route."""
    path = lasting_server.create(name="tour", world=paper_world())
    for document in paper_steps()[:8]:
        lasting_server.step(path, document)
    return path


def assert_fits(body: bytes, model: type[BaseModel]) -> None:
    """Hold a body against its description: nothing missing, nothing of another type, no more."""
    described = model.model_validate_json(body)
    assert json.loads(described.model_dump_json(exclude_unset=True)) == json.loads(body)


@pytest.mark.parametrize(
    ("below", "model", "media_type"),
    [
        ("", SessionAnswer, "application/json"),
        ("/graph", GraphAnswer, "application/json"),
        ("/graph?at=3", GraphAnswer, "application/json"),
        ("/zones", ZonesAnswer, GEOJSON),
        ("/zones?at=3&bbox=0,0,5,5", ZonesAnswer, GEOJSON),
        ("/zones?at=0", ZonesAnswer, GEOJSON),
        ("/zones?since=7", ZonesAnswer, GEOJSON),
        ("/graph?since=0", GraphAnswer, "application/json"),
        ("/borders?since=7", BordersAnswer, GEOJSON),
        ("/doorways?since=3&at=7", DoorwaysAnswer, GEOJSON),
        ("/borders", BordersAnswer, GEOJSON),
        ("/borders?at=0", BordersAnswer, GEOJSON),
        ("/doorways", DoorwaysAnswer, GEOJSON),
        ("/doorways?at=0", DoorwaysAnswer, GEOJSON),
        ("/steps", StepsAnswer, "application/json"),
        ("/steps?after=7&limit=1", StepsAnswer, "application/json"),
        ("/trail", TrailAnswer, "application/json"),
        ("/trail?after=2&limit=3", TrailAnswer, "application/json"),
        ("/scan", SightAnswer, "application/json"),
        ("/scan?at=0", SightAnswer, "application/json"),
        ("/world", WorldDocument, "application/json"),
        ("/route?from=corridor&to=A", RouteAnswer, "application/json"),
        ("/route?from=A&to=A", RouteAnswer, "application/json"),
    ],
)
def test_readings_fit_their_description(
    server: Server, session: str, below: str, model: type[BaseModel], media_type: str
) -> None:
    answer = server.client.get(session + below)
    assert answer.status_code == 200
    assert answer.headers["Content-Type"] == media_type
    assert_fits(answer.content, model)


def test_a_session_begins_empty(server: Server) -> None:
    answer = server.client.post("/sessions", json={"name": "ours", "world": paper_world()})
    assert answer.status_code == 201
    assert_fits(answer.content, SessionAnswer)
    body = answer.json()
    assert answer.headers["Location"] == f"/sessions/{body['id']}"
    assert (body["name"], body["seq"]) == ("ours", 0)
    assert body["sensor"] == {"beams": 72, "range": 2.0, "samples": 20}
    assert body["mapping"] == MappingDocument().model_dump()
    assert (body["mapping"]["edges"], body["mapping"]["min_zone_area"]) == ("seen", 0.0)
    assert body["world"] == {"name": "corridor loop with four rooms", "zones": 10}
    path = answer.headers["Location"]
    assert server.client.get(path).json() == body
    assert json.loads(server.get(f"{path}/graph")) == {"seq": 0, "nodes": [], "edges": []}
    assert json.loads(server.get(f"{path}/zones"))["features"] == []
    assert json.loads(server.get(f"{path}/steps")) == {"steps": [], "next": None}


@pytest.mark.parametrize(
    ("session", "name"),
    [
        ({}, None),
        ({"name": None, "world": None}, None),
        ({"world": paper_world()}, "corridor loop with four rooms"),
        ({"world": {"zones": paper_world()["zones"]}}, None),
        ({"name": "Küche 2", "world": paper_world()}, "Küche 2"),
    ],
)
def test_a_session_without_a_name_has_its_worlds_or_its_id(
    server: Server, session: Json, name: str | None
) -> None:
    body = server.client.post("/sessions", json=session).json()
    assert body["name"] == (name or body["id"])


def test_a_step_answers_what_it_found(server: Server) -> None:
    path = server.create(world=paper_world())
    answer = server.client.post(f"{path}/step", json=paper_steps()[0])
    assert answer.status_code == 201
    assert_fits(answer.content, StepAnswer)
    body = answer.json()
    assert (body["seq"], body["here"]) == (1, "corridor")
    assert body["events"] == [{"type": "node", "label": "corridor", "zone_id": "corridor"}]
    stages = {key: time for key, time in body["timings_ms"].items() if key != "total"}
    assert all(time >= 0 for time in stages.values())
    assert body["timings_ms"]["total"] == pytest.approx(sum(stages.values()), abs=0.01)
    assert answer.headers["ETag"] == server.client.get(f"{path}/graph").headers["ETag"]


def test_a_scan_may_come_to_a_session_with_a_world(server: Server) -> None:
    path = server.create(world=paper_world())
    server.step(path, paper_steps()[0])
    body = server.step(path, at(0, 0, 0, ROOM_SCAN))
    assert [event["label"] for event in body["events"] if event["type"] == "node"] == [
        "hall", "room",
    ]  # fmt: skip
    assert body["timings_ms"]["measurement"] == 0


def test_a_step_that_sees_nothing_counts(server: Server) -> None:
    path = server.create()
    for seq, beams in enumerate([[], [[]] * 4, [[["door", 1.0]]] * 4], start=1):
        body = server.step(path, at(0, 0, 0, {**ROOM_SCAN, "beams": beams}))
        assert (body["seq"], body["here"], body["events"]) == (seq, None, [])
    assert json.loads(server.get(f"{path}/graph")) == {"seq": 3, "nodes": [], "edges": []}


def test_the_log_tells_what_came_in_and_what_was_answered(server: Server) -> None:
    path = server.create()
    given = [at(0, 0, 0.5, ROOM_SCAN), at(1, 0, 0, {**ROOM_SCAN, "kinds": {}})]
    answers = [server.step(path, document) for document in given]
    steps = json.loads(server.get(f"{path}/steps"))["steps"]
    assert [step["input"] for step in steps] == given
    assert [step["answer"] for step in steps] == answers
    assert all(re.fullmatch(r"\S+T\S+\.\d{3}\+00:00", step["taken_at"]) for step in steps)


def test_the_log_has_pages(server: Server) -> None:
    path = server.create()
    empty = at(0, 0, 0, {**ROOM_SCAN, "beams": []})
    for _ in range(105):
        server.step(path, empty)
    first = json.loads(server.get(f"{path}/steps"))
    assert [step["seq"] for step in first["steps"]] == list(range(1, 101))
    second = json.loads(server.get(f"{path}/steps", after=first["next"]))
    assert [step["seq"] for step in second["steps"]] == list(range(101, 106))
    assert second["next"] is None
    exactly = json.loads(server.get(f"{path}/steps", after=0, limit=105))
    assert (len(exactly["steps"]), exactly["next"]) == (105, None)
    beyond = json.loads(server.get(f"{path}/steps", after=2**31 - 1))
    assert beyond == {"steps": [], "next": None}


def pages_of_sessions(server: Server, **query: object) -> Iterator[list[Json]]:
    while True:
        page = server.get("/sessions", **query)
        assert_fits(page, SessionsAnswer)
        yield json.loads(page)["sessions"]
        if json.loads(page)["next"] is None:
            return
        query["cursor"] = json.loads(page)["next"]


@pytest.mark.parametrize("limit", [None, 7, 1000])
def test_sessions_have_pages(server: Server, limit: int | None) -> None:
    made = [server.create(name=f"n{number}").removeprefix("/sessions/") for number in range(110)]
    query = {} if limit is None else {"limit": limit}
    pages = list(pages_of_sessions(server, **query))
    assert all(len(page) == (limit or 100) for page in pages[:-1])
    listed = [session["id"] for page in pages for session in page]
    assert listed[-110:] == made
    assert len(set(listed)) == len(listed)
    pages = list(pages_of_sessions(server, order="newest", **query))
    assert all(len(page) == (limit or 100) for page in pages[:-1])
    assert [session["id"] for page in pages for session in page] == listed[::-1]


def test_after_a_deletion_nothing_is_left(server: Server) -> None:
    path = server.create(world=paper_world())
    other = server.create(world=paper_world())
    for document in paper_steps()[:5]:
        server.step(path, document)
        server.step(other, document)
    before = server.get(f"{other}/zones")
    answer = server.client.delete(path)
    assert (answer.status_code, answer.content) == (204, b"")
    calls = [
        ("GET", "", None), ("DELETE", "", None), ("GET", "/graph", None), ("GET", "/zones", None),
        ("GET", "/graph?at=1", None), ("GET", "/zones?at=1", None), ("GET", "/steps", None),
        ("GET", "/borders", None), ("GET", "/borders?at=1", None),
        ("GET", "/doorways", None),
        ("GET", "/route?from=A&to=A", None), ("POST", "/query", {"text": "path from A to A"}),
        ("POST", "/step", paper_steps()[0]), ("POST", "/step", {**paper_steps()[0], "seq": 2}),
    ]  # fmt: skip
    for method, below, body in calls:
        gone = server.client.request(method, path + below, json=body)
        assert (gone.status_code, gone.json()["code"]) == (404, "unknown_session"), below
    assert server.get(f"{other}/zones") == before
    ids = [session["id"] for page in pages_of_sessions(server, limit=1000) for session in page]
    assert path.removeprefix("/sessions/") not in ids


@pytest.mark.parametrize(
    ("method", "path", "allowed"),
    [
        ("PUT", "/sessions", "POST"),
        ("PATCH", "/sessions/x", "GET"),
        ("GET", "/sessions/x/step", "POST"),
        ("POST", "/sessions/x/graph", "GET"),
        ("DELETE", "/healthz", "GET"),
    ],
)
def test_a_wrong_method(server: Server, method: str, path: str, allowed: str) -> None:
    answer = server.client.request(method, path)
    assert (answer.status_code, answer.json()["code"]) == (405, "method_not_allowed")
    assert answer.headers["Content-Type"] == PROBLEM
    assert allowed in answer.headers["Allow"]


@pytest.mark.parametrize(
    "path",
    ["/nowhere", "/viewer/nowhere.js", "/viewer/%2e%2e/app.py",
     "/sessions/x/nowhere", "/sessions//graph", "/docs/files/nowhere.js",
     "/docs/files/../../pyproject.toml", "/docs/files/%2e%2e/%2e%2e/METADATA"],
)  # fmt: skip
def test_an_unknown_address(server: Server, path: str) -> None:
    answer = server.client.get(path)
    assert (answer.status_code, answer.json()["code"]) == (404, "not_found")
    assert answer.headers["Content-Type"] == PROBLEM
    ProblemAnswer.model_validate_json(answer.content)


@pytest.mark.parametrize("path", ["/healthz", "/readyz"])
def test_health(server: Server, path: str) -> None:
    assert_fits(server.get(path), HealthAnswer)


def test_metrics_are_in_the_format_of_prometheus(server: Server) -> None:
    answer = server.client.get("/metrics")
    assert answer.headers["Content-Type"].startswith("text/plain; version=")
    assert re.search(r"^process_cpu_seconds_total \d", answer.text, re.MULTILINE)


def test_the_docs_need_no_internet(server: Server) -> None:
    page = server.client.get("/docs")
    assert page.headers["Content-Type"].startswith("text/html")
    assert not re.search(r"(https?:)?//\w", page.text)
    files = re.findall(r'(?:src|href)="([^"]+)"', page.text)
    assert any(name.endswith(".js") for name in files)
    assert any(name.endswith(".css") for name in files)
    for name in files:
        assert len(server.get(f"/{name}")) > 500


def test_the_description_names_every_call(server: Server) -> None:
    described = json.loads(server.get("/openapi.json"))
    calls = {(verb, path) for path, verbs in described["paths"].items() for verb in verbs}
    below = "/sessions/{session_id}"
    assert calls == {
        ("post", "/sessions"), ("get", "/sessions"), ("get", below), ("delete", below),
        ("post", f"{below}/step"), ("get", f"{below}/steps"), ("get", f"{below}/graph"),
        ("get", f"{below}/zones"), ("get", f"{below}/route"), ("post", f"{below}/query"),
        ("get", f"{below}/borders"), ("get", f"{below}/doorways"), ("get", f"{below}/map.{{form}}"),
        ("get", f"{below}/export/{{form}}"),
        ("get", f"{below}/events"), ("get", f"{below}/trail"), ("get", f"{below}/scan"),
        ("get", f"{below}/world"), ("put", f"{below}/zones/{{zone_id}}"),
        ("get", f"{below}/restrictions"), ("post", f"{below}/restrictions"),
        ("delete", f"{below}/restrictions/{{restriction_id}}"),
        ("get", "/healthz"), ("get", "/readyz"), ("get", "/metrics"),
    }  # fmt: skip


def test_many_requests_on_one_connection(server: Server, session: str) -> None:
    with httpx2.Client(base_url=server.client.base_url) as client:
        assert {client.get(f"{session}/graph").content for _ in range(20)} == {
            server.get(f"{session}/graph")
        }
