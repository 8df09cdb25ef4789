"""A step is taken once: keys, sequence numbers and entity tags."""

from __future__ import annotations

import json
from collections.abc import Iterator

import httpx2
import pytest

from tests.servers import Json, Server
from tests.service.twin import at, paper_steps, paper_world

pytestmark = pytest.mark.databases("sqlite", "postgres")

STEPS = paper_steps()


@pytest.fixture
def session(server: Server) -> str:
    """Give a new session in the paper's world."""
    return server.create(world=paper_world())


def take(
    server: Server, path: str, document: Json, headers: dict[str, str] | None = None
) -> httpx2.Response:
    return server.client.post(f"{path}/step", json=document, headers=headers)


def refusal(answer: httpx2.Response) -> tuple[int, str]:
    assert answer.headers["Content-Type"] == "application/problem+json"
    return answer.status_code, answer.json()["code"]


def last_step(server: Server, path: str) -> int:
    seq: int = json.loads(server.get(path))["seq"]
    return seq


def replayed(answer: httpx2.Response) -> bool:
    return answer.headers.get("Idempotency-Replayed") == "true"


@pytest.mark.parametrize("key", ["k", '"k"', "8e03978e-40d5-43dd-bc93-6894a57f9324", "x" * 255])
def test_a_key_replays_the_first_answer(server: Server, session: str, key: str) -> None:
    first = take(server, session, STEPS[0], {"Idempotency-Key": key})
    assert not replayed(first)
    take(server, session, STEPS[1])
    again = take(server, session, STEPS[0], {"Idempotency-Key": key})
    assert (again.status_code, again.content) == (201, first.content)
    assert again.headers["ETag"] == first.headers["ETag"]
    assert replayed(again)
    assert last_step(server, session) == 2


def test_a_key_in_quotes_is_the_same_key(server: Server, session: str) -> None:
    first = take(server, session, STEPS[0], {"Idempotency-Key": '"abc"'})
    again = take(server, session, STEPS[0], {"Idempotency-Key": "abc"})
    assert replayed(again)
    assert again.content == first.content


def test_a_key_with_another_step_is_refused(server: Server, session: str) -> None:
    take(server, session, STEPS[0], {"Idempotency-Key": "k"})
    answer = take(server, session, STEPS[1], {"Idempotency-Key": "k"})
    assert refusal(answer) == (422, "key_reused")
    assert last_step(server, session) == 1


def test_a_key_counts_by_value_and_not_by_spelling(server: Server, session: str) -> None:
    first = take(server, session, {"pose": {"x": 1, "y": 6}}, {"Idempotency-Key": "k"})
    same = {"seq": 1, "pose": {"theta": 0.0, "y": 6.0, "x": 1.0}, "scan": None}
    assert take(server, session, same, {"Idempotency-Key": "k"}).content == first.content


def test_a_key_belongs_to_its_session(server: Server, session: str) -> None:
    other = server.create(world=paper_world())
    take(server, session, STEPS[0], {"Idempotency-Key": "k"})
    answer = take(server, other, STEPS[1], {"Idempotency-Key": "k"})
    assert answer.status_code == 201
    assert not replayed(answer)


def test_a_refused_step_does_not_use_up_its_key(server: Server, session: str) -> None:
    key = {"Idempotency-Key": "k"}
    assert refusal(take(server, session, {**STEPS[0], "seq": 5}, key)) == (409, "sequence_gap")
    taken = take(server, session, STEPS[1], key)
    assert taken.status_code == 201
    assert not replayed(taken)


def test_a_seq_is_taken_in_order(server: Server, session: str) -> None:
    for seq, document in enumerate(STEPS[:4], start=1):
        answer = take(server, session, {**document, "seq": seq})
        assert answer.json()["seq"] == seq
        assert not replayed(answer)


@pytest.mark.parametrize("seq", [1, 2, 3])
def test_a_seq_replays_its_answer(server: Server, session: str, seq: int) -> None:
    answers = [take(server, session, document) for document in STEPS[:3]]
    again = take(server, session, {**STEPS[seq - 1], "seq": seq})
    assert again.content == answers[seq - 1].content
    assert again.headers["ETag"] == answers[seq - 1].headers["ETag"]
    assert replayed(again)
    assert last_step(server, session) == 3


def test_a_seq_with_another_step_is_refused(server: Server, session: str) -> None:
    for document in STEPS[:3]:
        take(server, session, document)
    answer = take(server, session, {**STEPS[0], "seq": 2})
    assert refusal(answer) == (422, "sequence_reused")
    assert last_step(server, session) == 3


@pytest.mark.parametrize("seq", [4, 1000, 2**31 - 1])
def test_a_gap_names_the_step_that_is_expected(server: Server, session: str, seq: int) -> None:
    for document in STEPS[:2]:
        take(server, session, document)
    answer = take(server, session, {**STEPS[2], "seq": seq})
    assert refusal(answer) == (409, "sequence_gap")
    assert answer.json()["expected"] == 3
    assert last_step(server, session) == 2


def test_if_match_takes_a_step_on_the_map_it_names(server: Server, session: str) -> None:
    empty = server.client.get(f"{session}/graph").headers["ETag"]
    first = take(server, session, STEPS[0], {"If-Match": empty})
    assert first.status_code == 201
    second = take(server, session, STEPS[1], {"If-Match": f'"other", {first.headers["ETag"]}'})
    assert second.status_code == 201
    assert take(server, session, STEPS[2], {"If-Match": "*"}).status_code == 201


@pytest.mark.parametrize("weak", ["", "W/"])
def test_if_match_refuses_a_step_on_another_map(server: Server, session: str, weak: str) -> None:
    tags = [server.client.get(f"{session}/graph").headers["ETag"]]
    tags.append(take(server, session, STEPS[0]).headers["ETag"])
    wanted = tags[0] if not weak else weak + tags[1]  # a weak tag never matches (RFC 9110, 13.1.1)
    answer = take(server, session, STEPS[1], {"If-Match": wanted})
    assert refusal(answer) == (412, "version_mismatch")
    assert last_step(server, session) == 1


@pytest.mark.parametrize("by", ["key", "seq"])
def test_a_retry_wins_over_if_match(server: Server, session: str, by: str) -> None:
    empty = server.client.get(f"{session}/graph").headers["ETag"]
    headers = {"If-Match": empty, **({"Idempotency-Key": "k"} if by == "key" else {})}
    document = {**STEPS[0], "seq": 1} if by == "seq" else STEPS[0]
    first = take(server, session, document, headers)
    take(server, session, STEPS[1])
    again = take(server, session, document, headers)
    assert (again.status_code, again.content) == (201, first.content)


@pytest.mark.parametrize("below", ["graph", "zones", "graph?at=1", "zones?bbox=0,0,1,1"])
def test_an_unchanged_map_is_not_sent_again(server: Server, session: str, below: str) -> None:
    for document in STEPS[:2]:
        take(server, session, document)
    address = f"{session}/{below}"
    tag = server.client.get(address).headers["ETag"]
    for known in (tag, f"W/{tag}", f'"x", {tag}', "*"):
        answer = server.client.get(address, headers={"If-None-Match": known})
        assert (answer.status_code, answer.content) == (304, b"")
        assert answer.headers["ETag"] == tag
    take(server, session, STEPS[2])
    answer = server.client.get(address, headers={"If-None-Match": tag})
    assert answer.status_code == (304 if "at=" in below else 200)


def test_a_tag_of_another_session_is_not_known(server: Server, session: str) -> None:
    other = server.create(world=paper_world())
    tag = server.client.get(f"{other}/graph").headers["ETag"]
    answer = server.client.get(f"{session}/graph", headers={"If-None-Match": tag})
    assert answer.status_code == 200
    assert refusal(take(server, session, STEPS[0], {"If-Match": tag}))[0] == 412


def test_retries_work_after_a_crash(own_server: Server) -> None:
    own_server.start()
    path = own_server.create(world=paper_world())
    first = take(own_server, path, STEPS[0], {"Idempotency-Key": "k"})
    own_server.restart()
    for document, headers in ((STEPS[0], {"Idempotency-Key": "k"}), ({**STEPS[0], "seq": 1}, {})):
        again = take(own_server, path, document, headers)
        assert replayed(again)
        assert again.content == first.content
    reused = take(own_server, path, STEPS[1], {"Idempotency-Key": "k"})
    assert refusal(reused) == (422, "key_reused")
    assert last_step(own_server, path) == 1


def headers_that_mean_nothing() -> Iterator[tuple[str, bytes]]:
    """Yield headers that cannot be read."""
    for key in (b"", b'""', b'"a', b'a"', b"a b", b"x" * 256, b'"' + b"x" * 256 + b'"', b"\xe9"):
        yield "Idempotency-Key", key
    for name in ("If-Match", "If-None-Match"):
        for tags in (b"", b"abc", b'"a', b'"a",', b'"' + b"x" * 101 + b'"', b'"a",' * 300 + b'"a"'):
            yield name, tags


@pytest.mark.parametrize(("name", "value"), list(headers_that_mean_nothing()))
def test_headers_that_mean_nothing(server: Server, session: str, name: str, value: bytes) -> None:
    headers = [(name.encode(), value)]
    if name == "If-None-Match":
        answer = server.client.get(f"{session}/graph", headers=headers)
    else:
        answer = server.client.post(f"{session}/step", json=at(1, 6), headers=headers)
    assert refusal(answer) == (422, "invalid_request")
    assert last_step(server, session) == 0
