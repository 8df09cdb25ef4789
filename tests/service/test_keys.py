"""A service that asks for API keys: who has one sees the sessions made with it, and no others."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import httpx2
import pytest

from service import key_desk
from tests.servers import Server
from tests.service.twin import at

CALLS = [
    ("GET", ""), ("DELETE", ""), ("GET", "/graph"), ("GET", "/zones"), ("GET", "/borders"),
    ("GET", "/doorways"), ("GET", "/steps"), ("GET", "/route?from=a&to=b"), ("POST", "/step"),
    ("POST", "/query"), ("GET", "/trail"), ("GET", "/scan"), ("GET", "/world"),
    ("GET", "/map.png"), ("GET", "/export/nav2"), ("PUT", "/zones/A"), ("GET", "/restrictions"),
    ("POST", "/restrictions"), ("DELETE", "/restrictions/0"),
]  # fmt: skip


@pytest.fixture(scope="module")
def guarded(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    """Give a running server that asks for keys."""
    server = Server(tmp_path_factory.mktemp("guarded"), keys=True)
    server.start()
    yield server
    server.close()
    assert server.faults() == []


def call(server: Server, method: str, path: str, bearer: str | None) -> httpx2.Response:
    bodies: dict[str, dict[str, Any]] = {
        "step": at(1, 6), "query": {"text": "path from a to b"}, "sessions": {}, "A": {},
        "restrictions": {"zone": "A", "closed": True},
    }  # fmt: skip
    body = bodies.get(path.rpartition("/")[2]) if method in {"POST", "PUT"} else None
    headers = [] if bearer is None else [(b"Authorization", f"Bearer {bearer}".encode("latin-1"))]
    return server.client.request(method, path, json=body, headers=headers)


@pytest.mark.parametrize("key", [None, "-", "x", "semtopo__", "semtopo_00_x", "é" * 50, "k" * 190])
def test_without_a_key_nothing_is_told(guarded: Server, key: str | None) -> None:
    paths = [("POST", "/sessions"), ("GET", "/sessions")]
    for method, path in paths + [(method, f"/sessions/nobody{below}") for method, below in CALLS]:
        answer = call(guarded, method, path, key)
        assert (answer.status_code, answer.json()["code"]) == (401, "unauthorized"), path
        assert answer.headers["Content-Type"] == "application/problem+json"


@pytest.mark.parametrize("path", ["/healthz", "/readyz", "/metrics", "/docs", "/openapi.json"])
def test_how_the_service_is_needs_no_key(guarded: Server, path: str) -> None:
    assert guarded.client.get(path).status_code == 200


def test_a_key_opens_its_own_sessions_only(guarded: Server) -> None:
    ours, theirs = (key_desk.add(guarded.url, name) for name in ("ours", "theirs"))
    made = call(guarded, "POST", "/sessions", ours)
    path = made.headers["Location"]
    for method, below in CALLS:
        foreign = call(guarded, method, path + below, theirs)
        assert (foreign.status_code, foreign.json()["code"]) == (404, "unknown_session"), below
    listed = [call(guarded, "GET", "/sessions", key).json()["sessions"] for key in (ours, theirs)]
    assert [[one["id"] for one in some] for some in listed] == [[made.json()["id"]], []]
    for body in ("", "/graph", "/zones", "/borders", "/doorways", "/map.svg", "/steps"):
        assert call(guarded, "GET", path + body, ours).status_code == 200


def test_a_key_works_until_it_is_revoked(guarded: Server) -> None:
    key = key_desk.add(guarded.url, "lost")
    for wrong in (key[:-1], f"{key}x", key.replace("semtopo_", "other_"), key.swapcase()):
        assert call(guarded, "GET", "/sessions", wrong).status_code == 401
    assert call(guarded, "GET", "/sessions", key).status_code == 200
    assert guarded.client.get("/sessions", headers={"Authorization": key}).status_code == 401
    key_desk.revoke(guarded.url, "lost")
    assert call(guarded, "GET", "/sessions", key).status_code == 401


def test_a_key_is_not_stored(guarded: Server) -> None:
    key = key_desk.add(guarded.url, "secret")
    secret = key.rpartition("_")[2].encode()
    files = guarded.database.parent.glob("semtopo.db*")
    assert not any(secret in file.read_bytes() for file in files)
    assert any(line.startswith("secret\t") for line in key_desk.listed(guarded.url))
