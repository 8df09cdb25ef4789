"""Every request leaves one line: what, by which id, how it ended; and nothing of what it held."""

from __future__ import annotations

import json
import re
import time
from collections.abc import Iterator
from typing import Any

import pytest

from tests.servers import Server
from tests.service.twin import paper_steps, paper_world

SECRET = "semtopo_0123456789ab_secret"  # noqa: S105 -- of nobody


@pytest.fixture(scope="module")
def own(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    server = Server(tmp_path_factory.mktemp("journal"))
    server.start()
    yield server
    server.close()
    assert server.faults() == []


def lines(server: Server, request_id: str) -> list[dict[str, Any]]:
    """Return what was written about a request; every line of the log is a JSON object.

    It is written when the answer has left, so there may be nothing yet.
    """
    give_up = time.monotonic() + 30
    while True:
        whole = server.log.read_text().rpartition("\n")[0].splitlines()
        told = [json.loads(line) for line in whole]
        assert all({"time", "level", "logger", "message", "request_id"} <= set(it) for it in told)
        mine = [it for it in told if it["request_id"] == request_id]
        if mine or time.monotonic() > give_up:
            return mine
        time.sleep(0.01)


def test_a_request_is_told_of_by_its_template(own: Server) -> None:
    path = own.create(world=paper_world())
    answer = own.client.post(
        f"{path}/step", json=paper_steps()[0], headers={"X-Request-ID": "drive-1.a_B"}
    )
    assert answer.headers["X-Request-ID"] == "drive-1.a_B"
    (line,) = lines(own, "drive-1.a_B")
    assert (line["method"], line["path"]) == ("POST", "/sessions/{session_id}/step")
    assert (line["status"], line["session"]) == (201, path.rpartition("/")[2])
    assert 0 < line["ms"] < 60_000
    assert line["level"] == "info"
    assert re.fullmatch(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\.\d{3}\+00:00", line["time"])


@pytest.mark.parametrize("given", ["", "a b", "x" * 129, '"', "a;b", "a,b"])
def test_an_id_that_could_be_anything_is_not_taken(own: Server, given: str) -> None:
    answer = own.client.get("/healthz", headers={"X-Request-ID": given})
    made = answer.headers["X-Request-ID"]
    assert re.fullmatch(r"[0-9a-f]{16}", made)
    assert [line["path"] for line in lines(own, made)] == ["/healthz"]


def test_ids_are_told_apart(own: Server) -> None:
    made = {own.client.get("/healthz").headers["X-Request-ID"] for _ in range(20)}
    assert len(made) == 20


def test_nothing_that_came_in_is_written(own: Server) -> None:
    own.client.get(f"/{SECRET}?a={SECRET}", headers={"Authorization": f"Bearer {SECRET}"})
    own.client.post("/sessions", json={"name": SECRET}, headers={"Idempotency-Key": SECRET})
    own.client.get(f"/sessions/x?a={SECRET}", headers={"X-Request-ID": "last"})
    assert lines(own, "last")
    assert SECRET not in own.log.read_text()


def test_an_unknown_address_has_no_template(own: Server) -> None:
    answer = own.client.get("/nowhere")
    (line,) = lines(own, answer.headers["X-Request-ID"])
    assert (line["path"], line["status"], line["session"]) == (None, 404, None)


def test_the_log_can_be_plain(tmp_path_factory: pytest.TempPathFactory) -> None:
    server = Server(tmp_path_factory.mktemp("plain"), log="text")
    server.start()
    server.client.get("/healthz", headers={"X-Request-ID": "plain-1"})
    server.close()
    (line,) = [it for it in server.log.read_text().splitlines() if "plain-1" in it]
    assert "INFO service.journal: request request_id=plain-1 method=GET path=/healthz" in line
