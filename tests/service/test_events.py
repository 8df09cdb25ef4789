"""Following a session: every step is told, in order, once, and only when it is on disk."""

from __future__ import annotations

import json
import socket
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import httpx2
import pytest

from service import key_desk
from tests.servers import Json, Server
from tests.service.sse import Told, following
from tests.service.twin import at, paper_steps, paper_world

SESSION: Json = {"world": paper_world(), "sensor": {"beams": 36}}
STEPS = paper_steps()
STOP_SECONDS_MAX = 5.0
LATE_SECONDS_MAX = 5.0

on_both = pytest.mark.databases("sqlite", "postgres")


def told_of(step: Json, answer: Json) -> tuple[str, str, Json]:
    """Return the event that a step leads to."""
    return ("step", str(answer["seq"]), {**answer, "pose": step["pose"]})


def as_tuples(events: list[Told]) -> list[tuple[str, str, Json]]:
    return [(one.event, one.id, one.data) for one in events]


@on_both
def test_steps_are_told_as_they_were_answered(server: Server) -> None:
    path = server.create(**SESSION)
    with following(server, path) as reader:
        answers = [server.step(path, step) for step in STEPS]
        expected = [told_of(*pair) for pair in zip(STEPS, answers, strict=True)]
        assert as_tuples(reader.take(len(STEPS))) == expected
    assert any(answer["events"] for answer in answers)


@on_both
@pytest.mark.parametrize("after", [0, 1, 40, 80, 81])
def test_a_reader_goes_on_after_the_last_event(server: Server, after: int) -> None:
    path = server.create(**SESSION)
    answers = [server.step(path, step) for step in STEPS]
    with following(server, path, after) as reader:
        assert reader.id == f"{after}.0"
        last = server.step(path, STEPS[0])
        expected = [told_of(*pair) for pair in zip(STEPS, answers, strict=True)][after:]
        events = as_tuples(reader.take(len(STEPS) + 1 - after))
        assert events == [*expected, told_of(STEPS[0], last)]


def test_a_long_log_is_told_whole(server: Server) -> None:
    """More steps than are read at once, or kept for readers."""
    path = server.create(**SESSION)
    for step in STEPS * 5:
        server.step(path, step)
    with following(server, path, 0) as reader:
        assert [int(one.id) for one in reader.take(405)] == list(range(1, 406))


def test_who_comes_without_an_id_hears_what_comes(server: Server) -> None:
    path = server.create(**SESSION)
    for step in STEPS[:5]:
        server.step(path, step)
    with following(server, path) as reader:
        assert reader.id == "5.0"
        server.step(path, STEPS[5])
        assert reader.next().id == "6"


def test_what_was_told_can_be_read(server: Server) -> None:
    """An event is told after the commit: the map of that step is there already."""
    path = server.create(**SESSION)
    with following(server, path) as reader, ThreadPoolExecutor() as threads:
        driving = threads.submit(lambda: [server.step(path, step) for step in STEPS])
        for _ in STEPS:
            event = reader.next()
            log = json.loads(server.get(f"{path}/steps", after=int(event.id) - 1, limit=1))
            answer = {key: value for key, value in event.data.items() if key != "pose"}
            assert log["steps"][0]["answer"] == answer
        driving.result()


def test_a_refused_or_repeated_step_is_not_told(server: Server) -> None:
    path = server.create(**SESSION)
    with following(server, path) as reader:
        first = server.step(path, STEPS[0], {"Idempotency-Key": "one"})
        server.step(path, STEPS[0], {"Idempotency-Key": "one"})
        assert server.client.post(f"{path}/step", json={**STEPS[1], "seq": 9}).status_code == 409
        second = server.step(path, STEPS[1])
        expected = [told_of(STEPS[0], first), told_of(STEPS[1], second)]
        assert as_tuples(reader.take(2)) == expected


def test_a_step_with_a_scan_is_told_without_it(server: Server) -> None:
    path = server.create()
    scan = {"angle_min": 0.0, "angle_increment": 1.0, "range_max": 2.0, "kinds": {}}
    step = at(1.5, -2.25, 0.5, {**scan, "beams": [[["hall", 1.0]]] * 6})
    with following(server, path) as reader:
        answer = server.step(path, step)
        assert as_tuples([reader.next()]) == [told_of({"pose": step["pose"]}, answer)]


@on_both
def test_the_end_of_a_session_is_told(server: Server) -> None:
    path = server.create(**SESSION)
    with following(server, path) as reader:
        server.step(path, STEPS[0])
        server.client.delete(path).raise_for_status()
        assert [one.event for one in reader][-1] == "deleted"


def close_passage(server: Server, path: str, source: str, target: str) -> str:
    """Close a passage, and return the address of what closes it."""
    on = {"passage": {"source": source, "target": target}, "closed": True}
    made = server.client.post(f"{path}/restrictions", json=on)
    assert made.status_code == 201, made.text
    return f"{path}/restrictions/{made.json()['id']}"


@on_both
def test_changes_are_told_among_the_steps(server: Server) -> None:
    path = server.create(**SESSION)
    for step in STEPS[:7]:
        server.step(path, step)
    with following(server, path) as reader:
        closed = close_passage(server, path, "corridor", "A")
        server.step(path, STEPS[7])
        server.client.delete(closed).raise_for_status()
        named = server.client.put(f"{path}/zones/A", json={"aliases": ["kitchen"]})
        assert named.status_code == 200, named.text
        server.step(path, STEPS[8])
        live = as_tuples(reader.take(5))
    ids = ["7.1", "8", "8.2", "8.3", "9"]
    assert [id_ for _, id_, _ in live] == ids
    assert [data["kind"] for event, _, data in live if event == "change"] == [
        "restriction", "lifted", "zone",
    ]  # fmt: skip
    assert live[0][2]["change"]["passage"] == {"source": "corridor", "target": "A"}
    assert live[3][2]["change"]["aliases"] == ["kitchen"]
    for number, after in enumerate(["7", *ids]):
        with following(server, path, after) as reader:
            assert as_tuples(reader.take(5 - number)) == live[number:]
    with following(server, path) as reader:
        assert reader.id == "9.3"


@on_both
def test_changes_by_another_process_are_told(server: Server, other: Server) -> None:
    path = server.create(**SESSION)
    for step in STEPS[:7]:
        server.step(path, step)
    with following(server, path) as reader:
        close_passage(other, path, "corridor", "A")
        assert reader.next().id == "7.1"


@pytest.mark.parametrize("header", ["", "x", "-1", "1.5.2", "1.", ".1", "1e3", "9" * 11, "٣"])
def test_an_id_that_is_none_is_refused(server: Server, header: str) -> None:
    path = server.create(**SESSION)
    headers = [(b"Last-Event-ID", header.encode())]
    answer = server.client.get(f"{path}/events", headers=headers)
    assert (answer.status_code, answer.json()["code"]) == (422, "invalid_request")


def test_an_id_to_come_is_refused(server: Server) -> None:
    path = server.create(**SESSION)
    answer = server.client.get(f"{path}/events", headers={"Last-Event-ID": "1"})
    assert (answer.status_code, answer.json()["code"]) == (404, "unknown_step")
    missing = server.client.get("/sessions/nobody/events")
    assert (missing.status_code, missing.json()["code"]) == (404, "unknown_session")


@pytest.fixture
def other(server: Server, tmp_path: Path) -> Iterator[Server]:
    """Give a second server on the same database."""
    second = Server(tmp_path / "second", server.url)
    second.start()
    yield second
    second.close()
    assert second.faults() == []


@on_both
def test_steps_by_another_process_are_told(server: Server, other: Server) -> None:
    path = server.create(**SESSION)
    with following(server, path) as reader:
        answers = [other.step(path, step) for step in STEPS[:10]]
        asked_at = time.monotonic()
        expected = [told_of(*pair) for pair in zip(STEPS, answers, strict=False)]
        assert as_tuples(reader.take(10)) == expected
        assert time.monotonic() - asked_at < LATE_SECONDS_MAX
        other.client.delete(path).raise_for_status()
        assert reader.next().event == "deleted"


def test_a_server_stops_although_it_is_followed(
    own_server: Server, stopping: Callable[[Server], float]
) -> None:
    own_server.start()
    path = own_server.create(**SESSION)
    with following(own_server, path) as one, following(own_server, path) as other:
        own_server.step(path, STEPS[0])
        assert (one.next().id, other.next().id) == ("1", "1")
        seconds = stopping(own_server)
        assert list(one) == list(other) == []
    assert seconds < STOP_SECONDS_MAX
    own_server.start()
    with following(own_server, path, 1) as again:
        own_server.step(path, STEPS[1])
        assert again.next().id == "2"


@pytest.fixture
def stopping() -> Callable[[Server], float]:
    """Give what stops a server, and says how long that took in s."""

    def stop(server: Server) -> float:
        began = time.monotonic()
        server.stop()
        return time.monotonic() - began

    return stop


def test_a_reader_that_takes_nothing_keeps_no_robot_waiting(own_server: Server) -> None:
    """The stalled reader is sent more than all buffers hold, and later gets what was left out."""
    own_server.start()
    path = own_server.create(**SESSION)
    connection = socket.socket()
    connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4_096)
    connection.connect(("127.0.0.1", own_server.port))
    request = f"GET {path}/events HTTP/1.1\r\nHost: here\r\nLast-Event-ID: 0\r\n\r\n"
    for step in STEPS * 5:
        own_server.step(path, step)
    connection.sendall(request.encode())
    with following(own_server, path, 400) as reader:
        took = []
        for step in STEPS[:40]:
            began = time.monotonic()
            own_server.step(path, step)
            took.append(time.monotonic() - began)
        assert reader.take(45)[-1].id == "445"
    assert sorted(took)[len(took) // 2] < 0.25
    connection.settimeout(30)
    got = b""
    while b"id: 445\n" not in got:
        more = connection.recv(2**16)
        assert more, "closed"
        got += more
    ids = [line[4:] for line in got.split(b"\n") if line.startswith(b"id: ")]
    assert ids == [b"0.0", *(b"%d" % seq for seq in range(1, 446))]
    connection.close()


def test_readers_that_are_gone_are_forgotten(server: Server) -> None:
    def readers() -> float:
        lines = server.get("/metrics").decode().splitlines()
        (found,) = [line for line in lines if line.startswith("semtopo_event_readers")]
        return float(found.split()[1])

    path = server.create(**SESSION)
    before = readers()
    with following(server, path), following(server, path):
        assert readers() == before + 2
    give_up = time.monotonic() + 10
    while readers() > before:
        assert time.monotonic() < give_up
        time.sleep(0.02)


def test_there_is_a_limit_to_readers(tmp_path: Path) -> None:
    server = Server(tmp_path / "small", readers_max=2)
    server.start()
    path = server.create(**SESSION)
    with following(server, path), following(server, path):
        answer = server.client.get(f"{path}/events")
        assert (answer.status_code, answer.json()["code"]) == (503, "busy")
        assert answer.headers["Retry-After"] == "1"
    server.close()
    assert server.faults() == []


def test_a_key_is_needed_and_a_revoked_one_ends_the_stream(tmp_path: Path) -> None:
    server = Server(tmp_path / "guarded", keys=True)
    server.start()
    ours, theirs = (key_desk.add(server.url, name) for name in ("ours", "theirs"))
    bearer = {"Authorization": f"Bearer {ours}"}
    made = server.client.post("/sessions", json=SESSION, headers=bearer)
    path = made.headers["Location"]
    assert server.client.get(f"{path}/events").status_code == 401
    foreign = server.client.get(f"{path}/events", headers={"Authorization": f"Bearer {theirs}"})
    assert foreign.status_code == 404
    with following(server, path, key=ours) as reader:
        server.step(path, STEPS[0], bearer)
        assert reader.next().id == "1"
        key_desk.revoke(server.url, "ours")
        assert list(reader) == []
    assert server.client.get(f"{path}/events", headers=bearer).status_code == 401
    server.close()
    assert server.faults() == []


def test_idle_streams_are_kept_alive(server: Server) -> None:
    """Longer than any connection may else be idle, with a heartbeat at least each 15 s."""
    path = server.create(**SESSION)
    with following(server, path) as reader:
        late = threading.Timer(16.0, server.step, (path, STEPS[0]))
        late.start()
        assert reader.next().id == "1"
        assert reader.comments >= 1
        late.join()


def test_a_hundred_readers_hear_the_same(server: Server) -> None:
    path = server.create(**SESSION)

    def follow(_number: int) -> list[tuple[str, str, Json]]:
        with following(server, path, 0) as reader:
            return as_tuples(reader.take(20))

    with ThreadPoolExecutor(100) as threads:
        heard = threads.map(follow, range(100))
        answers = [server.step(path, step) for step in STEPS[:20]]
        expected = [told_of(*pair) for pair in zip(STEPS, answers, strict=False)]
        assert all(one == expected for one in heard)


def test_head_of_the_answer(server: Server) -> None:
    path = server.create(**SESSION)
    with httpx2.stream("GET", f"{server.client.base_url}{path}/events") as answer:
        assert answer.headers["X-Accel-Buffering"] == "no"
