"""What the service bears, and how it says that it will not: more would do harm to everybody."""

from __future__ import annotations

import json
import time
from concurrent.futures import ThreadPoolExecutor

import httpx2
import pytest

from service.metrics import Metrics
from service.store import PAGE_CHARACTERS
from tests.servers import Json, Server
from tests.service.twin import Twin, at, paper_steps, paper_world, untimed


def samples(server: Server) -> dict[str, float]:
    """Return what /metrics shows, by name with labels."""
    lines = server.get("/metrics").decode().splitlines()
    found = (line.rpartition(" ") for line in lines if not line.startswith("#"))
    return {name: float(value) for name, _, value in found}


# Methods and retries


@pytest.mark.parametrize(
    ("path", "methods"),
    [
        ("/sessions", {"GET", "POST"}),
        ("/sessions/x", {"DELETE", "GET"}),
        ("/sessions/x/step", {"POST"}),
        ("/sessions/x/graph", {"GET"}),
        ("/healthz", {"GET"}),
        ("/openapi.json", {"GET", "HEAD"}),
    ],
)
def test_a_wrong_method_is_told_the_right_ones(
    server: Server, path: str, methods: set[str]
) -> None:
    for method in {"DELETE", "GET", "PATCH", "POST", "PUT"} - methods:
        headers = {"Content-Type": "application/json"}
        answer = server.client.request(method, path, headers=headers)
        assert (answer.status_code, answer.json()["code"]) == (405, "method_not_allowed")
        assert set(answer.headers["Allow"].split(", ")) == methods


def test_a_retry_may_write_its_kinds_in_another_order(server: Server) -> None:
    path = server.create()
    about = {"angle_min": 0, "angle_increment": 1, "range_max": 4, "beams": [[["a", 1]]] * 3}
    kinds = {"b": "passage", "a": "space", "c": "obstacle"}
    document = at(0, 0, 0, {**about, "kinds": kinds})
    again = at(0, 0, 0, {**about, "kinds": dict(reversed(kinds.items()))})
    headers = {"Idempotency-Key": "k"}
    assert server.step(path, document, headers) == server.step(path, again, headers)
    assert json.loads(server.get(path))["seq"] == 1


# Too much at once


def heavy_session(server: Server) -> str:
    """Begin a session whose steps take long: many beams among zones that lie on one another."""
    zones = [
        {"label": f"z{n}", "kind": "space", "low": [0, n / 1e3], "high": [9, n / 1e3 + 5e-4]}
        for n in range(4_000)
    ]
    sensor = {"beams": 1_000, "range": 2.0, "samples": 100}
    return server.create(world={"zones": zones}, sensor=sensor)


def test_too_many_steps_are_asked_to_come_again(tmp_path_factory: pytest.TempPathFactory) -> None:
    server = Server(tmp_path_factory.mktemp("busy"), queue_max=2)
    server.start()
    heavy = heavy_session(server)
    light = server.create(world=paper_world())

    def step(path: str, document: Json) -> httpx2.Response:
        return server.client.post(f"{path}/step", json=document)

    with ThreadPoolExecutor(8) as pool:
        asked = [pool.submit(step, heavy, at(4, 2)) for _ in range(8)]
        answers = [one.result() for one in asked]
    statuses = [answer.status_code for answer in answers]
    assert set(statuses) == {201, 503}
    for answer in answers:
        if answer.status_code == 503:
            assert answer.json()["code"] == "busy"
            assert answer.headers["Retry-After"] == "1"
            assert answer.headers["Content-Type"] == "application/problem+json"
    assert json.loads(server.get(heavy))["seq"] == statuses.count(201)
    assert step(light, paper_steps()[0]).status_code == 201
    shown = samples(server)
    assert shown['semtopo_steps_total{outcome="busy"}'] == statuses.count(503)
    assert shown["semtopo_waiting_steps"] == 0
    server.close()
    assert server.faults() == []


def test_others_are_served_during_a_long_step(server: Server) -> None:
    heavy = heavy_session(server)
    with ThreadPoolExecutor(1) as pool:
        asked = pool.submit(server.step, heavy, at(4, 2))
        waits = []
        while not asked.done():
            waits.append(server.client.get("/healthz").elapsed.total_seconds())
        assert asked.result()["seq"] == 1
    assert max(waits) < 1.0


def test_maps_that_do_not_fit_into_memory_are_read_again(
    tmp_path_factory: pytest.TempPathFactory,
) -> None:
    server = Server(tmp_path_factory.mktemp("small"), hot_bytes_max=0, cached_bytes_max=0)
    server.start()
    twins = {server.create(world=paper_world()): Twin({"world": paper_world()}) for _ in range(3)}
    for document in paper_steps()[:6]:
        for path, twin in twins.items():
            assert untimed(server.step(path, document)) == twin.step(document)
            assert server.get(f"{path}/zones") == twin.zones()
    assert samples(server)["semtopo_hot_sessions"] == 1
    server.close()
    assert server.faults() == []


def test_a_map_has_a_bound(server: Server) -> None:
    path = server.create()

    def look(number: int) -> Json:
        """Return a step that sees 1,000 labels, which no other step sees."""
        beams = [[[f"z{number}.{n // 2}", 4.0]] for n in range(2_000)]
        about = {"angle_min": 0, "angle_increment": 1e-3, "range_max": 4.0}
        return at(0, 0, 0, {**about, "beams": beams})

    for number in range(10):
        server.step(path, look(number))
    before = server.get(f"{path}/graph")
    answer = server.client.post(f"{path}/step", json=look(10))
    assert (answer.status_code, answer.json()["code"]) == (409, "map_full")
    assert server.get(f"{path}/graph") == before
    assert server.step(path, look(3))["seq"] == 11


# Pages of the log


@pytest.fixture
def long_log(server: Server) -> str:
    """Give a session of 7 steps whose inputs are nearly 1 MiB each."""
    path = server.create()
    label = "x" * 100
    scan = {
        "angle_min": 0, "angle_increment": 1e-3, "range_max": 9.0,
        "beams": [[[label, (n + 1) / 2] for n in range(5)]] * 1_800, "kinds": {label: "obstacle"},
    }  # fmt: skip
    for _ in range(7):
        server.step(path, at(0, 0, 0, scan))
    return path


def test_a_page_of_the_log_has_a_bound_in_bytes(server: Server, long_log: str) -> None:
    found: list[int] = []
    after, pages = 0, 0
    while pages == 0 or after:
        body = server.get(f"{long_log}/steps", after=after, limit=1000)
        assert len(body) < 1.1 * PAGE_CHARACTERS
        page = json.loads(body)
        found += [step["seq"] for step in page["steps"]]
        after, pages = page["next"], pages + 1
    assert found == list(range(1, 8))
    assert pages == 2
    one = json.loads(server.get(f"{long_log}/steps", after=6, limit=1))
    assert ([step["seq"] for step in one["steps"]], one["next"]) == ([7], None)


# Metrics


def grown(server: Server, before: dict[str, float]) -> dict[str, float]:
    return {name: value - before.get(name, 0) for name, value in samples(server).items()}


@pytest.fixture
def counted(server: Server) -> dict[str, float]:
    """Give what /metrics showed before the test."""
    return samples(server)


def test_steps_are_counted_by_outcome(server: Server, counted: dict[str, float]) -> None:
    path = server.create(world=paper_world())
    for number in (0, 1, 2, 0):
        server.step(path, paper_steps()[number], {"Idempotency-Key": str(number)})
    refused = server.client.post(f"{path}/step", json={**at(0, 0), "seq": 9})
    assert refused.status_code == 409
    give_up = time.monotonic() + 10
    while (now := grown(server, counted))["semtopo_commit_seconds_count"] <= 3:
        assert time.monotonic() < give_up  # commits are told of after the answers
    assert now['semtopo_steps_total{outcome="recorded"}'] == 3
    assert now['semtopo_steps_total{outcome="replayed"}'] == 1
    assert now['semtopo_steps_total{outcome="refused"}'] == 1
    stages = [name for name in now if name.startswith("semtopo_step_seconds_count")]
    assert len(stages) == 6
    assert all(now[stage] == 3 for stage in stages)
    assert now['semtopo_step_seconds_sum{stage="total"}'] > 0
    assert now["semtopo_commit_seconds_count"] == now["semtopo_commit_changes_count"] > 3
    assert now["semtopo_commit_changes_sum"] >= now["semtopo_commit_seconds_count"]
    assert now["semtopo_queued_changes"] == 0


def test_responses_are_counted_by_status(server: Server, counted: dict[str, float]) -> None:
    for path in ("/healthz", "/sessions/nobody", "/nowhere"):
        server.client.get(path)
    now = grown(server, counted)
    assert now['semtopo_http_responses_total{status="2xx"}'] == 2  # with the first /metrics
    assert now['semtopo_http_responses_total{status="4xx"}'] == 2
    assert samples(server)["semtopo_hot_sessions"] >= 1
    assert samples(server)["semtopo_hot_bytes"] > 0


def test_applications_count_for_themselves() -> None:
    one, other = Metrics(), Metrics()
    one.count_step("recorded")
    assert b'semtopo_steps_total{outcome="recorded"} 1.0' in one.written()
    assert b"outcome" not in other.written()
