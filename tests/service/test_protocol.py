"""Connections, byte by byte: the slow are closed, the honest are served."""

from __future__ import annotations

import json
import re
import select
import socket
import sys
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import ExitStack, suppress

import pytest
import uvicorn
from starlette.types import Receive, Scope, Send

from service import protocol
from service.protocol import HEAD_BYTES_MAX, PatientProtocol
from tests.servers import Server, free_port
from tests.service.twin import at, paper_world

CLOSED_SECONDS_MAX = 15.0
PING_SECONDS_MAX = 0.5  # 0.1 on a machine that does nothing else
GET = b"GET /healthz HTTP/1.1\r\nHost: here\r\n\r\n"
CREATE_HEAD = (
    b"POST /sessions HTTP/1.1\r\nHost: here\r\nContent-Type: application/json\r\n"
    b"Content-Length: %d\r\n\r\n"
)


@pytest.fixture
def connect(server: Server) -> Iterator[Callable[[], socket.socket]]:
    """Give what opens a connection."""
    with ExitStack() as opened:
        yield lambda: opened.enter_context(
            socket.create_connection(("127.0.0.1", server.port), timeout=30)
        )


def read_answers(connection: socket.socket, count: int = 1) -> list[tuple[int, bytes]]:
    """Read answers that declare their length: status and body of each."""
    answers: list[tuple[int, bytes]] = []
    got = b""
    while len(answers) < count:
        head, found, rest = got.partition(b"\r\n\r\n")
        length = re.search(rb"(?i)content-length: (\d+)", head)
        if found and length and len(rest) >= int(length[1]):
            answers.append((int(head.split()[1]), rest[: int(length[1])]))
            got = rest[int(length[1]) :]
            continue
        more = connection.recv(65_536)
        assert more, f"closed after {got[:200]!r}"
        got += more
    assert got == b""
    return answers


def is_closed(connection: socket.socket) -> bool:
    """Say whether the server has closed a connection, and read away what it sent."""
    while select.select([connection], [], [], 0)[0]:
        try:
            if not connection.recv(65_536):
                return True
        except OSError:
            return True
    return False


def trickle(connection: socket.socket, byte: bytes) -> None:
    try:
        connection.send(byte)
    except OSError:
        return  # closed by the server


def test_300_slow_connections_are_closed_while_others_are_served(
    server: Server, connect: Callable[[], socket.socket]
) -> None:
    idle, heads, bodies = ([connect() for _ in range(100)] for _ in range(3))
    stray = [connect() for _ in range(5)]
    for connection in heads:
        connection.sendall(b"GET /healthz HTTP/1.1\r\nX-Slow: ")
    for connection in bodies:
        connection.sendall(CREATE_HEAD % 1_000)
    for connection in stray:
        connection.sendall(GET)
        read_answers(connection)
        connection.sendall(b"\r\n\r\n")  # which is no request
    began, pings = time.monotonic(), []
    slow = [*idle, *heads, *bodies, *stray]
    while slow and time.monotonic() - began < CLOSED_SECONDS_MAX:
        for connection in {*heads, *bodies} & set(slow):
            trickle(connection, b"x")
        asked = time.monotonic()
        assert server.client.get("/healthz").status_code == 200
        pings.append(time.monotonic() - asked)
        time.sleep(0.2)
        slow = [connection for connection in slow if not is_closed(connection)]
    print(f"closed after {time.monotonic() - began:.1f} s; slowest ping {max(pings):.3f} s")  # noqa: T201 -- for -s
    assert slow == []
    assert max(pings) < PING_SECONDS_MAX


@pytest.fixture
def answering() -> Iterator[int]:
    """Give the port of a server that answers everything with 16 MiB."""

    async def app(scope: Scope, _receive: Receive, send: Send) -> None:
        assert scope["type"] == "http"
        await send({"type": "http.response.start", "status": 200, "headers": []})
        await send({"type": "http.response.body", "body": bytes(2**24)})

    config = uvicorn.Config(app, port=free_port(), http=PatientProtocol, lifespan="off")
    server = uvicorn.Server(config)
    thread = threading.Thread(target=server.run)
    thread.start()
    while not server.started:
        time.sleep(0.01)
    yield config.port
    server.should_exit = True
    thread.join()


def test_a_client_that_does_not_read_its_answer_is_let_go(
    answering: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(protocol, "ANSWER_SECONDS", 0.5)
    for pause, is_whole in ((0.0, True), (2.0, False)):
        with socket.create_connection(("127.0.0.1", answering), timeout=30) as connection:
            connection.sendall(GET)
            time.sleep(pause)
            got = 0
            with suppress(ConnectionResetError):
                while more := connection.recv(2**20):
                    got += len(more)
                    if got > 2**24:
                        break
            assert (got > 2**24) is is_whole


@pytest.mark.parametrize("part", ["path", "header", "headers"])
def test_a_head_above_its_bound_is_refused(connect: Callable[[], socket.socket], part: str) -> None:
    connection = connect()
    filler = b"x" * (HEAD_BYTES_MAX + 1_000)
    head = {
        "path": b"GET /" + filler,
        "header": b"GET / HTTP/1.1\r\nX-Long: " + filler,
        "headers": b"GET / HTTP/1.1\r\n" + b"X-Many: 1\r\n" * (len(filler) // 10),
    }[part]
    connection.sendall(head)
    status, body = read_answers(connection)[0]
    assert (status, json.loads(body)["code"]) == (400, "malformed_request")
    assert connection.recv(1) == b""


def test_many_heads_together_may_be_longer(connect: Callable[[], socket.socket]) -> None:
    connection = connect()
    header = b"X-Long: " + b"x" * 30_000 + b"\r\n"
    for _ in range(5):
        connection.sendall(GET.replace(b"\r\n\r\n", b"\r\n" + header + b"\r\n"))
        assert read_answers(connection)[0][0] == 200


def test_a_client_that_is_slow_but_comes_to_an_end_is_served(
    server: Server, connect: Callable[[], socket.socket]
) -> None:
    body = json.dumps({"name": "slow", "world": paper_world()}).encode()
    message = CREATE_HEAD % len(body) + body
    connection = connect()
    size = len(message) // 20 + 1
    for start in range(0, len(message), size):
        connection.sendall(message[start : start + size])
        time.sleep(0.15)  # 3 s in all
    status, answer = read_answers(connection)[0]
    assert (status, json.loads(answer)["name"]) == (201, "slow")
    path = f"/sessions/{json.loads(answer)['id']}"
    assert server.step(path, at(1, 6))["here"] == "corridor"


def test_connections_are_kept(connect: Callable[[], socket.socket]) -> None:
    connection = connect()
    for _ in range(3):
        connection.sendall(GET)
        assert read_answers(connection) == [(200, b'{"status":"ok"}')]
        time.sleep(0.3)


def test_requests_may_be_sent_before_the_answers_come(
    connect: Callable[[], socket.socket],
) -> None:
    connection = connect()
    names = [f"n{number}" for number in range(20)]
    bodies = [json.dumps({"name": name}).encode() for name in names]
    connection.sendall(b"".join(CREATE_HEAD % len(body) + body for body in bodies) + GET[:-2])
    answers = read_answers(connection, len(names))
    assert [json.loads(body)["name"] for _, body in answers] == names
    connection.sendall(b"\r\n")
    assert read_answers(connection) == [(200, b'{"status":"ok"}')]


@pytest.mark.parametrize("reset", [True, False], ids=["reset", "closed"])
@pytest.mark.parametrize(
    "sent",
    [
        CREATE_HEAD % 1_000 + b'{"name": "half',
        CREATE_HEAD.replace(b"Content-Length: %d", b"Transfer-Encoding: chunked") + b"5\r\n{",
        CREATE_HEAD % 2 + b"{}",
        b"GET /hea",
    ],
    ids=["in a body", "in a chunk", "before the answer", "in a head"],
)
def test_a_connection_that_dies_is_no_fault(
    server: Server, connect: Callable[[], socket.socket], sent: bytes, *, reset: bool
) -> None:
    """The fixture `server` sees to it that no traceback is logged."""
    for _ in range(5):
        connection = connect()
        connection.sendall(sent)
        time.sleep(0.05)
        if reset:
            connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, b"\1\0\0\0\0\0\0\0")
        connection.close()
    time.sleep(0.2)
    assert server.client.get("/healthz").status_code == 200


@pytest.mark.parametrize(
    "sent",
    [
        b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03",  # the begin of TLS
        b"HELLO\r\n\r\n",
        b"GET /\xff HTTP/1.1\r\n\r\n",
        b"GET / HTTP/9.9\r\n\r\n",
        b"POST /sessions HTTP/1.1\r\nContent-Length: 1e3\r\n\r\n",
        b"POST /sessions HTTP/1.1\r\nContent-Length: 1\r\nContent-Length: 2\r\n\r\n{}",
        b"POST /sessions HTTP/1.1\r\nContent-Length: 3\r\nTransfer-Encoding: chunked\r\n\r\n{}",
        b"GET / HTTP/1.1\r\nX-Null: a\0b\r\n\r\n",
    ],
)
def test_what_is_no_http_is_refused(connect: Callable[[], socket.socket], sent: bytes) -> None:
    connection = connect()
    connection.sendall(sent)
    assert read_answers(connection)[0][0] == 400
    assert connection.recv(1) == b""


def test_an_upgrade_is_not_taken_up(server: Server, connect: Callable[[], socket.socket]) -> None:
    connection = connect()
    connection.sendall(
        b"GET /healthz HTTP/1.1\r\nHost: here\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
        b"Sec-WebSocket-Key: x3JJHMbDL1EzLkh9GBhXDw==\r\nSec-WebSocket-Version: 13\r\n\r\n"
    )
    assert read_answers(connection)[0][0] == 200
    assert server.client.get("/healthz").status_code == 200


@pytest.mark.parametrize(
    "sent", [b"\x16\x03\x01\x02\x00", b"GET\r\n\r\n", b"FETCH / HTTP/9\r\n\r\n"]
)
def test_what_is_no_http_is_a_problem_too(
    connect: Callable[[], socket.socket], sent: bytes
) -> None:
    connection = connect()
    connection.sendall(sent)
    head, _, body = connection.recv(65_536).partition(b"\r\n\r\n")
    assert head.startswith(b"HTTP/1.1 400 Bad Request\r\n")
    assert b"content-type: application/problem+json" in head
    assert json.loads(body)["code"] == "malformed_request"
    assert connection.recv(1) == b""


def count_answers(server: Server, connections: int) -> Counter[int]:
    """Open so many connections at once, ask on each, and count the answers by status."""
    with ExitStack() as opened:
        crowd = [
            opened.enter_context(socket.create_connection(("127.0.0.1", server.port), timeout=30))
            for _ in range(connections)
        ]
        for connection in crowd:
            with suppress(OSError):
                connection.sendall(GET)
        found: Counter[int] = Counter()
        for connection in crowd:
            with suppress(OSError):
                found[int(connection.recv(65_536).split(b" ")[1])] += 1
    return found


def test_more_connections_than_there_may_be_are_refused(
    tmp_path_factory: pytest.TempPathFactory,
) -> None:
    server = Server(tmp_path_factory.mktemp("crowded"), connections_max=20)
    server.start()
    server.client.close()  # its own connection would count
    found = count_answers(server, 30)
    assert found.keys() <= {200, 503}
    assert found[200] >= 19
    assert found.total() > 20
    time.sleep(1)
    with socket.create_connection(("127.0.0.1", server.port), timeout=30) as again:
        again.sendall(GET)
        assert read_answers(again)[0][0] == 200
    server.stop()
    assert server.faults() == []


LAUNCHER = """
import os, resource, sys
resource.setrlimit(resource.RLIMIT_NOFILE, (int(sys.argv[1]), int(sys.argv[2])))
os.execv(sys.argv[3], sys.argv[3:])
"""


@pytest.mark.parametrize(("soft", "hard", "served"), [(100, 1_000, 300), (200, 200, 72)])
def test_a_server_knows_how_many_descriptors_it_may_have(
    tmp_path_factory: pytest.TempPathFactory, soft: int, hard: int, served: int
) -> None:
    server = Server(tmp_path_factory.mktemp("few"))
    server.launcher = [sys.executable, "-c", LAUNCHER, str(soft), str(hard)]
    server.start()
    server.client.close()
    found = count_answers(server, 300)
    assert found.keys() <= {200, 503}
    assert served - 2 <= found[200] <= served
    assert ("at most 72 connections" in server.log.read_text()) == (served == 72)
    server.stop()
    assert server.faults() == []
