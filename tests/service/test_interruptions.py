"""Clients that hang up in the middle: a step is taken whole or not at all, and once."""

from __future__ import annotations

import json
import random
import socket
import struct
import time

import pytest

from tests.robots import check_map, read_log
from tests.servers import Json, Server
from tests.service.twin import paper_steps, paper_world

pytestmark = pytest.mark.databases("sqlite", "postgres")

SESSION: Json = {"world": paper_world(), "sensor": {"beams": 36}}
STEPS = paper_steps()[:25]


@pytest.fixture
def session(server: Server) -> str:
    return server.create(**SESSION)


def request_bytes(path: str, document: Json, key: str) -> bytes:
    body = json.dumps(document).encode()
    head = (
        f"POST {path}/step HTTP/1.1\r\nHost: x\r\nContent-Type: application/json\r\n"
        f"Idempotency-Key: {key}\r\nContent-Length: {len(body)}\r\n\r\n"
    )
    return head.encode() + body


def hang_up(server: Server, request: bytes, *, after: float = 0, roughly: bool = False) -> None:
    """Send a request, and close the connection without waiting for the answer."""
    with socket.create_connection(("127.0.0.1", server.port)) as connection:
        connection.sendall(request)
        time.sleep(after)
        if roughly:  # a reset, and not a farewell
            linger = struct.pack("ii", 1, 0)
            connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, linger)


def wait_for(server: Server, path: str, seq: int) -> None:
    """Wait until a session has come to a step."""
    give_up = time.monotonic() + 20
    while json.loads(server.get(path))["seq"] != seq:
        assert time.monotonic() < give_up
        time.sleep(0.02)


def test_who_hangs_up_at_once_has_still_taken_the_step(server: Server, session: str) -> None:
    for number, document in enumerate(STEPS):
        hang_up(server, request_bytes(session, document, f"k{number}"))
        wait_for(server, session, number + 1)
    log = read_log(server, session)
    assert [one["input"] for one in log] == STEPS
    check_map([server], session, log)


@pytest.mark.parametrize("roughly", [False, True])
def test_who_hangs_up_and_asks_again_takes_the_step_once(
    server: Server, session: str, *, roughly: bool
) -> None:
    chance, replayed = random.Random(1), 0
    for number, document in enumerate(STEPS):
        request = request_bytes(session, document, f"k{number}")
        hang_up(server, request, after=chance.uniform(0, 0.01), roughly=roughly)
        answer = server.client.post(
            f"{session}/step", json=document, headers={"Idempotency-Key": f"k{number}"}
        )
        assert (answer.status_code, answer.json()["seq"]) == (201, number + 1)
        replayed += "Idempotency-Replayed" in answer.headers
    assert replayed > 0
    log = read_log(server, session)
    assert [one["input"] for one in log] == STEPS
    check_map([server], session, log)


def test_half_a_request_is_no_step(server: Server, session: str) -> None:
    request = request_bytes(session, STEPS[0], "k")
    for length in (1, 20, len(request) // 2, len(request) - 20, len(request) - 1):
        for roughly in (False, True):
            hang_up(server, request[:length], after=0.01, roughly=roughly)
    time.sleep(0.2)
    assert json.loads(server.get(session))["seq"] == 0
    assert server.step(session, STEPS[0], {"Idempotency-Key": "k"})["seq"] == 1
