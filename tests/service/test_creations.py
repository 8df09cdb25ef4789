"""A session that is asked for again and again with one key begins once."""

from __future__ import annotations

import threading
from collections.abc import Callable

import httpx2
import pytest

from service.key_desk import add
from tests.servers import Json, Server
from tests.service.twin import paper_steps, paper_world

pytestmark = pytest.mark.databases("sqlite", "postgres")

SESSION: Json = {"name": "ours", "world": paper_world(), "sensor": {"beams": 36}}


def begin(
    server: Server, key: str, document: Json = SESSION, **headers: str
) -> httpx2.Response:  # fmt: skip
    return server.client.post(
        "/sessions", json=document, headers={"Idempotency-Key": key, **headers}
    )


def test_a_retry_gets_the_session_that_began(server: Server) -> None:
    first = begin(server, "retry")
    assert first.status_code == 201
    assert "Idempotency-Replayed" not in first.headers
    server.step(first.headers["Location"], paper_steps()[0])
    again = begin(server, '"retry"')  # in quotes, it is the same key
    assert (again.status_code, again.content) == (201, first.content)
    assert again.headers["Location"] == first.headers["Location"]
    assert again.headers["Idempotency-Replayed"] == "true"
    newest = server.client.get("/sessions", params={"order": "newest", "limit": 1}).json()
    assert newest["sessions"][0]["id"] == first.json()["id"]  # and not a second one


def test_the_same_session_written_otherwise_is_the_same(server: Server) -> None:
    first = begin(server, "order")
    again = begin(server, "order", {name: SESSION[name] for name in reversed(SESSION)})
    assert again.content == first.content


@pytest.mark.parametrize("other", [{}, {**SESSION, "name": "other"}, {"name": "ours"}])
def test_another_session_may_not_have_the_key(server: Server, other: Json) -> None:
    begin(server, "taken")
    refused = begin(server, "taken", other)
    assert (refused.status_code, refused.json()["code"]) == (422, "key_reused")


@pytest.mark.parametrize("key", ["", "k" * 256, "a b", '"'])
def test_a_bad_key_begins_nothing(server: Server, key: str) -> None:
    assert begin(server, key).json()["code"] == "invalid_request"


def test_after_a_deletion_the_key_is_free(server: Server) -> None:
    first = begin(server, "gone")
    server.client.delete(first.headers["Location"])
    again = begin(server, "gone")
    assert again.status_code == 201
    assert again.json()["id"] != first.json()["id"]


def test_a_key_of_a_step_is_none_of_a_session(server: Server) -> None:
    path = begin(server, "both").headers["Location"]
    assert server.step(path, paper_steps()[0], {"Idempotency-Key": "both"})["seq"] == 1


def test_of_many_that_ask_at_once_all_get_one_session(server: Server) -> None:
    def ask() -> None:
        with httpx2.Client(base_url=server.client.base_url, timeout=30) as client:
            while True:
                answer = client.post(
                    "/sessions", json=SESSION, headers={"Idempotency-Key": "together"}
                )
                if answer.status_code != 503:  # on PostgreSQL the second waits, and is told so
                    bodies.append(answer.content)
                    return

    bodies: list[bytes] = []
    askers = [threading.Thread(target=ask) for _ in range(8)]
    for asker in askers:
        asker.start()
    for asker in askers:
        asker.join()
    assert len(bodies) == 8
    assert len(set(bodies)) == 1


def test_keys_outlive_a_crash(own_server: Server) -> None:
    own_server.start()
    first = begin(own_server, "crash")
    own_server.restart()
    assert begin(own_server, "crash").content == first.content


def test_owners_have_keys_of_their_own(
    new_database: Callable[[], str], tmp_path_factory: pytest.TempPathFactory
) -> None:
    server = Server(tmp_path_factory.mktemp("keys"), new_database(), keys=True)
    server.start()
    try:
        owners = [f"Bearer {add(server.url, name)}" for name in ("one", "two")]
        first = [begin(server, "k", Authorization=owner).json()["id"] for owner in owners]
        again = [begin(server, "k", Authorization=owner).json()["id"] for owner in owners]
        assert first == again
        assert first[0] != first[1]
    finally:
        server.close()
