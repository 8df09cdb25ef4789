"""Two processes on one database: steps through both count once each, and each sees the other's."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor

import httpx2
import pytest

from tests.robots import check_map, read_log
from tests.servers import Json, Server
from tests.service.twin import PAPER, Twin, at, paper_steps, paper_world

pytestmark = pytest.mark.databases("sqlite", "postgres")

SESSION: Json = {"world": paper_world(), "sensor": {"beams": 36}}
STEPS = paper_steps()
Pair = tuple[Server, Server]


@pytest.fixture(scope="module")
def lasting_pair(
    new_database: Callable[[], str], tmp_path_factory: pytest.TempPathFactory
) -> Iterator[Pair]:
    """Give two running servers on one database."""
    url = new_database()
    one, two = (Server(tmp_path_factory.mktemp(name), url) for name in ("one", "two"))
    with ThreadPoolExecutor() as threads:
        list(threads.map(Server.start, (one, two)))  # at once, so that both would migrate
    yield one, two
    one.close()
    two.close()


@pytest.fixture
def pair(lasting_pair: Pair) -> Iterator[Pair]:
    """Give two running servers on one database. No test may make them log a traceback."""
    before = [len(server.faults()) for server in lasting_pair]
    yield lasting_pair
    faults = [server.faults() for server in lasting_pair]
    assert [found[n:] for found, n in zip(faults, before, strict=True)] == [[], []]


def ask_in_turn(pair: Pair, calls: Sequence[tuple[str, Json]]) -> list[httpx2.Response]:
    """Post all bodies at once, by one server and the other in turn."""

    async def ask() -> list[httpx2.Response]:
        async with httpx2.AsyncClient(timeout=60) as client:
            addresses = [
                f"http://127.0.0.1:{pair[number % 2].port}{path}"
                for number, (path, _) in enumerate(calls)
            ]
            bodies = [body for _, body in calls]
            return await asyncio.gather(
                *(client.post(url, json=it) for url, it in zip(addresses, bodies, strict=True))
            )

    return asyncio.run(ask())


def test_steps_through_both_count_once_each(pair: Pair) -> None:
    path = pair[0].create(**SESSION)
    given = STEPS[:40]
    answers = ask_in_turn(pair, [(f"{path}/step", body) for body in given])
    assert [answer.status_code for answer in answers] == [201] * len(given)
    assert sorted(answer.json()["seq"] for answer in answers) == list(range(1, len(given) + 1))
    log = read_log(pair[1], path)
    for answer, body in zip(answers, given, strict=True):
        logged = log[answer.json()["seq"] - 1]
        assert logged["answer"] == answer.json()
        assert logged["input"]["pose"] == body["pose"]
    check_map(pair, path, log)


def test_the_same_step_sent_to_both_is_taken_once(pair: Pair) -> None:
    path = pair[0].create(**SESSION)
    for seq in range(1, 9):
        body = {**STEPS[seq], "seq": seq}
        answers = ask_in_turn(pair, [(f"{path}/step", body)] * 6)
        assert {answer.status_code for answer in answers} == {201}
        assert len({answer.content for answer in answers}) == 1
        assert sum("Idempotency-Replayed" not in answer.headers for answer in answers) == 1
    assert len(read_log(pair[0], path)) == 8


def test_of_different_steps_with_one_number_one_wins(pair: Pair) -> None:
    path = pair[0].create(**SESSION)
    bodies = [{**at(1.0, 2.0 + number / 8), "seq": 1} for number in range(8)]
    answers = ask_in_turn(pair, [(f"{path}/step", body) for body in bodies])
    assert sorted(answer.status_code for answer in answers) == [201] + [422] * 7


def test_each_sees_at_once_what_the_other_did(pair: Pair) -> None:
    path, twin = pair[0].create(**SESSION), Twin(SESSION)
    for number, document in enumerate(STEPS[:30]):
        writes, reads = pair if number % 2 else pair[::-1]
        writes.step(path, document)
        twin.step(document)
        assert reads.get(f"{path}/graph") == twin.graph()
        assert reads.get(f"{path}/zones") == twin.zones()
        assert json.loads(reads.get(path))["seq"] == number + 1
        assert json.loads(reads.get(f"{path}/steps", after=number))["steps"][0]["seq"] == number + 1


@pytest.mark.parametrize("below", ["graph", "zones", "zones?bbox=0,0,9,9"])
def test_entity_tags_hold_for_both(pair: Pair, below: str) -> None:
    one, two = (server.client for server in pair)
    path = pair[0].create(**SESSION)
    for server, reader in ((pair[0], two), (pair[1], one)) * 3:
        step = server.client.post(f"{path}/step", json=STEPS[0])
        tags = {client.get(f"{path}/{below}").headers["ETag"] for client in (one, two)}
        assert tags == {step.headers["ETag"]}
        known = {"If-None-Match": step.headers["ETag"]}
        assert reader.get(f"{path}/{below}", headers=known).status_code == 304
        pair[0].step(path, STEPS[1])
        assert reader.get(f"{path}/{below}", headers=known).status_code == 200
        stale = {"If-Match": step.headers["ETag"]}
        refused = reader.post(f"{path}/step", json=STEPS[2], headers=stale)
        assert (refused.status_code, refused.json()["code"]) == (412, "version_mismatch")


def test_who_only_reads_sees_each_change_at_the_very_next_reading(pair: Pair) -> None:
    writes, reads = pair
    path = writes.create(**SESSION)
    for document in STEPS[:20]:
        tag = writes.client.post(f"{path}/step", json=document).headers["ETag"]
        for below in ("graph", "zones"):
            first = reads.client.get(f"{path}/{below}")
            assert (first.status_code, first.headers["ETag"]) == (200, tag)
            for _ in range(3):
                again = reads.client.get(f"{path}/{below}", headers={"If-None-Match": tag})
                assert again.status_code == 304
    assert writes.client.delete(path).status_code == 204
    for below in ("", "/graph", "/zones"):
        assert reads.client.get(path + below).status_code == 404


def test_notes_of_one_are_seen_by_the_other(pair: Pair) -> None:
    path = pair[0].create(**SESSION)
    for document in STEPS[:5]:
        pair[0].step(path, document)
    for number in range(6):
        writes, reads = (server.client for server in (pair if number % 2 else pair[::-1]))
        names = {"aliases": [f"name {number}"], "class": "office"}
        assert writes.put(f"{path}/zones/A", json=names).status_code == 200
        one, two = (client.get(f"{path}/graph") for client in (writes, reads))
        assert (one.content, one.headers["ETag"]) == (two.content, two.headers["ETag"])
        assert {"id": "A", "label": "A", **names} in two.json()["nodes"]
        asked = {"from": "corridor", "to": f"NAME {number}"}
        assert reads.get(f"{path}/route", params=asked).json()["target"] == "A"
        closed = {"passage": {"source": "corridor", "target": "A"}, "closed": True}
        made = writes.post(f"{path}/restrictions", json=closed)
        assert made.status_code == 201
        assert reads.get(f"{path}/route", params=asked).status_code == 409
        lifted = reads.delete(f"{path}/restrictions/{made.json()['id']}")
        assert lifted.status_code == 204
        reads.post(f"{path}/step", json=STEPS[number + 5])


def test_notes_and_steps_of_both_at_once(pair: Pair) -> None:
    """Each is stored once, in an order that both agree on."""
    path = pair[0].create(**SESSION)
    for document in STEPS[:5]:
        pair[0].step(path, document)
    with ThreadPoolExecutor() as threads:
        done = [threads.submit(_note, pair[number % 2], path, number) for number in range(12)]
        steps = [
            threads.submit(pair[number % 2].client.post, f"{path}/step", json=document)
            for number, document in enumerate(STEPS[5:13])
        ]
    assert {it.result().status_code for it in steps} == {201}
    assert {it.result().status_code for it in done} <= {200, 409}
    for below in ("/graph", "/zones", "/restrictions"):
        one, two = (server.client.get(path + below) for server in pair)
        assert (one.content, one.headers.get("ETag")) == (two.content, two.headers.get("ETag"))
    assert json.loads(pair[0].get(path))["seq"] == 13


def _note(server: Server, path: str, number: int) -> httpx2.Response:
    names = {"aliases": [f"name {number}"]}
    return server.client.put(f"{path}/zones/{'A' if number % 2 else 'corridor'}", json=names)


def test_a_key_is_known_to_both(pair: Pair) -> None:
    path = pair[0].create(**SESSION)
    key = {"Idempotency-Key": "k"}
    first = pair[0].client.post(f"{path}/step", json=STEPS[0], headers=key)
    pair[1].step(path, STEPS[1])
    again = pair[1].client.post(f"{path}/step", json=STEPS[0], headers=key)
    assert (again.status_code, again.content) == (201, first.content)
    assert (again.headers["ETag"], again.headers["Idempotency-Replayed"]) == (
        first.headers["ETag"], "true",
    )  # fmt: skip
    other = pair[1].client.post(f"{path}/step", json=STEPS[2], headers=key)
    assert (other.status_code, other.json()["code"]) == (422, "key_reused")


def test_what_one_deletes_is_gone_for_the_other(pair: Pair) -> None:
    path = pair[0].create(**SESSION)
    for server in pair * 2:
        server.step(path, STEPS[0])
        server.get(f"{path}/zones")
    assert pair[0].client.delete(path).status_code == 204
    for below in ("", "/graph", "/zones", "/zones?at=1", "/steps", "/route?from=A&to=A"):
        assert pair[1].client.get(path + below).status_code == 404, below
    for body in (STEPS[0], {**STEPS[0], "seq": 1}, {**STEPS[0], "seq": 9}):
        assert pair[1].client.post(f"{path}/step", json=body).status_code == 404
    assert pair[1].client.delete(path).status_code == 404


def test_a_deletion_under_way_in_the_other_process(pair: Pair) -> None:
    """Steps that race with it are taken, or find no session; afterwards nothing is left."""
    for _ in range(5):
        path = pair[0].create(**SESSION)
        with ThreadPoolExecutor() as threads:
            steps = [
                threads.submit(pair[0].client.post, f"{path}/step", json=body) for body in STEPS[:8]
            ]
            deleted = threads.submit(pair[1].client.delete, path)
        assert {step.result().status_code for step in steps} <= {201, 404}
        assert deleted.result().status_code == 204
        assert all(server.client.get(path).status_code == 404 for server in pair)


def test_both_make_the_example(
    new_database: Callable[[], str], tmp_path_factory: pytest.TempPathFactory
) -> None:
    """Started at once, they drive its path once."""
    url = new_database()
    servers = [
        Server(tmp_path_factory.mktemp("example"), url, example=str(PAPER)) for _ in range(2)
    ]
    try:
        with ThreadPoolExecutor() as threads:
            list(threads.map(Server.start, servers))
        twin = Twin.driven({"world": paper_world()}, STEPS)
        for server in servers:
            assert server.get("/sessions/example/zones") == twin.zones()
    finally:
        for server in servers:
            server.close()
