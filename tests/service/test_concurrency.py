"""Many robots at once: every step counts once, in one order, and the map is that of the log."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Sequence
from typing import Any

import httpx2
import pytest

from tests.servers import Json, Server
from tests.service.twin import Twin, at, paper_steps, paper_world, untimed

pytestmark = pytest.mark.databases("sqlite", "postgres")

CLIENTS = 12


async def together(server: Server, calls: Sequence[tuple[str, Json]]) -> list[httpx2.Response]:
    """Post all bodies at once, over a dozen connections."""
    limits = httpx2.Limits(max_connections=CLIENTS)
    async with httpx2.AsyncClient(
        base_url=server.client.base_url, limits=limits, timeout=60
    ) as client:
        return await asyncio.gather(*(client.post(path, json=body) for path, body in calls))


def log(server: Server, path: str) -> list[dict[str, Any]]:
    """Return the steps of a session, in order."""
    steps: list[dict[str, Any]] = json.loads(server.get(f"{path}/steps", limit=1000))["steps"]
    return steps


def assert_map_is_that_of_the_log(server: Server, path: str, session: Json) -> None:
    steps = log(server, path)
    assert [step["seq"] for step in steps] == list(range(1, len(steps) + 1))
    twin = Twin.driven(session, [step["input"] for step in steps])
    assert [untimed(step["answer"]) for step in steps] == twin.answers
    assert server.get(f"{path}/graph") == twin.graph()
    assert server.get(f"{path}/zones") == twin.zones()


def test_steps_of_many_clients_in_one_session(server: Server) -> None:
    session = {"world": paper_world()}
    path = server.create(**session)
    given = paper_steps() + paper_steps()[::-1]
    answers = asyncio.run(together(server, [(f"{path}/step", body) for body in given]))
    assert [answer.status_code for answer in answers] == [201] * len(given)
    taken = {answer.json()["seq"]: body for answer, body in zip(answers, given, strict=True)}
    assert sorted(taken) == list(range(1, len(given) + 1))
    logged = {step["seq"]: step for step in log(server, path)}
    for answer, body in zip(answers, given, strict=True):
        step = logged[answer.json()["seq"]]
        assert step["answer"] == answer.json()
        assert step["input"]["pose"] == body["pose"]
    assert_map_is_that_of_the_log(server, path, session)


def test_steps_of_many_clients_in_many_sessions(server: Server) -> None:
    session = {"world": paper_world(), "sensor": {"beams": 36}}
    paths = [server.create(**session) for _ in range(CLIENTS)]
    calls = [(f"{path}/step", body) for body in paper_steps()[:12] for path in paths]
    answers = asyncio.run(together(server, calls))
    assert {answer.status_code for answer in answers} == {201}
    for path in paths:
        assert_map_is_that_of_the_log(server, path, session)


def test_the_same_step_sent_many_times_at_once_is_taken_once(server: Server) -> None:
    path = server.create(world=paper_world())
    body = {**paper_steps()[0], "seq": 1}
    answers = asyncio.run(together(server, [(f"{path}/step", body)] * 24))
    assert {answer.status_code for answer in answers} == {201}
    assert len({answer.content for answer in answers}) == 1
    fresh = [answer for answer in answers if "Idempotency-Replayed" not in answer.headers]
    assert len(fresh) == 1
    assert len(log(server, path)) == 1


def test_of_many_steps_with_one_number_one_wins(server: Server) -> None:
    path = server.create(world=paper_world())
    bodies = [{**at(1.0, 2.0 + number / 8), "seq": 1} for number in range(24)]
    answers = asyncio.run(together(server, [(f"{path}/step", body) for body in bodies]))
    assert sorted(answer.status_code for answer in answers) == [201] + [422] * 23
    assert len(log(server, path)) == 1


def test_readers_see_whole_steps_only(server: Server) -> None:
    """While a robot drives, every map that is read is one that there was."""
    session = {"world": paper_world(), "sensor": {"beams": 36}}
    path, twin = server.create(**session), Twin.driven(session, paper_steps()[:40])

    async def drive_and_read() -> list[bytes]:
        async with httpx2.AsyncClient(base_url=server.client.base_url, timeout=60) as client:

            async def drive() -> None:
                for body in paper_steps()[:40]:
                    assert (await client.post(f"{path}/step", json=body)).status_code == 201

            async def read(what: str) -> list[bytes]:
                seen = []
                while not driving.done():
                    seen.append((await client.get(f"{path}/{what}")).content)
                return seen

            driving = asyncio.create_task(drive())
            bodies = await asyncio.gather(*(read(what) for what in ("graph", "zones") * 3))
            await driving
            return [body for some in bodies for body in some]

    seen = asyncio.run(drive_and_read())
    assert len(set(seen)) > 10
    there_were = {body for seq in range(41) for body in (twin.graph(seq), twin.zones(seq))}
    assert set(seen) <= there_were


def test_a_session_that_is_deleted_under_way(server: Server) -> None:
    """Steps that race with a deletion are taken, or find no session; nothing else."""
    path = server.create(world=paper_world())

    async def race() -> list[httpx2.Response]:
        async with httpx2.AsyncClient(base_url=server.client.base_url, timeout=60) as client:
            steps = [client.post(f"{path}/step", json=body) for body in paper_steps()[:16]]
            reads = [client.get(f"{path}/zones") for _ in range(8)]
            return await asyncio.gather(*steps[:4], client.delete(path), *steps[4:], *reads)

    statuses = [answer.status_code for answer in asyncio.run(race())]
    assert statuses.count(204) == 1
    assert set(statuses) <= {200, 201, 204, 404}
    assert server.client.get(path).status_code == 404


def test_who_hangs_up_does_not_stop_a_step(server: Server) -> None:
    path = server.create(world=paper_world(), sensor={"beams": 500, "samples": 200})

    async def hang_up() -> None:
        async with httpx2.AsyncClient(base_url=server.client.base_url) as client:
            sent = asyncio.create_task(client.post(f"{path}/step", json=at(1, 6)))
            await asyncio.sleep(0.03)
            sent.cancel()

    asyncio.run(hang_up())
    answer = server.step(path, at(1, 6.5))
    assert answer["seq"] in {1, 2}  # the first may not have left at all
    assert len(log(server, path)) == answer["seq"]
