"""Robots that never give up: each step is sent until it is answered, and every answer is kept.

Founders do the same with new sessions. Every request has an Idempotency-Key. Now and then a robot
hangs up in the middle of a request, and now and then it asks for an old answer again. `check` holds
what they were told against what is stored.
"""

from __future__ import annotations

import asyncio
import json
import random
import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar

import httpx2

from tests.servers import Json, Server
from tests.service.twin import Twin, paper_steps, paper_world, untimed

SESSIONS, ROBOTS, FOUNDERS = 8, 16, 2
SESSION: Json = {"world": paper_world(), "sensor": {"beams": 36}}
STEPS = paper_steps()

PAUSE, PAUSE_MAX = 0.02, 0.5  # s; doubled from try to try
HANG_UP, HANG_UP_SECONDS = 1 / 20, 0.03  # share of requests, and how soon at most
ASK_AGAIN = 1 / 20  # share of steps
THINK = 0.2  # s between steps at most, where there are two servers: one must be able to start
FOUND = 0.5  # s between new sessions at most
STEP_SECONDS_MAX = 120.0


@dataclass(frozen=True, slots=True)
class Answered:
    """What was answered: the body and tag (or place) of the answer, and how it was come by."""

    body: bytes
    tag: str
    replayed: bool
    hung_up: bool

    @property
    def seq(self) -> int:
        """The number that the step was given."""
        seq: int = json.loads(self.body)["seq"]
        return seq


@dataclass(slots=True)
class Stubborn:
    """A client that sends a request until it is answered, to any of the servers."""

    MARK: ClassVar = "ETag"

    name: str
    ports: list[int]
    chance: random.Random
    think: float = 0.0
    answered: list[Answered] = field(default_factory=list)
    attempts: int = 0
    refused: int = 0
    hung_up: int = 0
    asked_again: int = 0

    async def drive(self, stop: asyncio.Event) -> None:
        """Do one thing after another until told to stop; the one begun is brought to its end."""
        async with httpx2.AsyncClient(timeout=10) as client:
            while not stop.is_set():
                self.answered.append(await self._until_answered(client, len(self.answered)))
                if self.chance.random() < ASK_AGAIN:
                    await self.ask_again(client, self.chance.randrange(len(self.answered)))
                await asyncio.sleep(self.chance.uniform(0, self.think))

    async def ask_again(self, client: httpx2.AsyncClient, number: int) -> None:
        """Send an answered request once more; the answer must be the same."""
        self.asked_again += 1
        first, again = self.answered[number], await self._until_answered(client, number)
        assert again.replayed
        assert (again.body, again.tag) == (first.body, first.tag)

    def request(self, number: int) -> tuple[str, Json]:
        """Return the path and the body of a request."""
        raise NotImplementedError

    async def _until_answered(self, client: httpx2.AsyncClient, number: int) -> Answered:
        give_up, pause, hung_up = time.monotonic() + STEP_SECONDS_MAX, PAUSE, False
        while time.monotonic() < give_up:
            self.attempts += 1
            try:
                async with asyncio.timeout(self._patience()):
                    answer = await self._post(client, number)
            except TimeoutError:
                self.hung_up += 1
                hung_up = True
                continue
            except httpx2.TransportError:
                pass
            else:
                if answer.status_code == 201:
                    replayed = answer.headers.get("Idempotency-Replayed") == "true"
                    return Answered(answer.content, answer.headers[self.MARK], replayed, hung_up)
                assert answer.status_code == 503, (answer.status_code, answer.text)
                assert answer.headers["Content-Type"] == "application/problem+json"
                assert answer.headers["Retry-After"] == "1"
                self.refused += 1
            await asyncio.sleep(pause * self.chance.uniform(0.5, 1.5))
            pause = min(2 * pause, PAUSE_MAX)
        raise AssertionError(f"request {number} of {self.name} was not answered")

    async def _post(self, client: httpx2.AsyncClient, number: int) -> httpx2.Response:
        path, document = self.request(number)
        return await client.post(
            f"http://127.0.0.1:{self.chance.choice(self.ports)}{path}",
            json=document,
            headers={"Idempotency-Key": f"{self.name}-{number}"},
        )

    def _patience(self) -> float | None:
        """Return how long to wait before hanging up, in s; mostly, as long as it takes."""
        if self.chance.random() < HANG_UP:
            return self.chance.uniform(0, HANG_UP_SECONDS)
        return None


@dataclass(slots=True)
class Robot(Stubborn):
    """Takes steps in one session, one after the other."""

    session: str = field(kw_only=True)

    def request(self, number: int) -> tuple[str, Json]:
        """Return where a step is taken, and the step."""
        return f"{self.session}/step", STEPS[number % len(STEPS)]


@dataclass(slots=True)
class Founder(Stubborn):
    """Begins sessions, one after the other."""

    MARK: ClassVar = "Location"

    def request(self, number: int) -> tuple[str, Json]:
        """Return where sessions are begun, and one with a name of its own."""
        return "/sessions", {"name": f"{self.name}-{number}"}


def make_robots(servers: Sequence[Server], seed: int) -> list[Robot]:
    """Begin sessions, and put the robots into them, two in each."""
    sessions = [servers[0].create(**SESSION) for _ in range(SESSIONS)]
    ports, think = [server.port for server in servers], THINK if len(servers) > 1 else 0.0
    return [
        Robot(f"robot-{n}", ports, random.Random(seed + n), think, session=sessions[n % SESSIONS])
        for n in range(ROBOTS)
    ]


def make_founders(servers: Sequence[Server], seed: int) -> list[Founder]:
    """Return those who begin further sessions, now and then."""
    ports = [server.port for server in servers]
    return [
        Founder(f"founder-{n}", ports, random.Random(-seed - n), FOUND) for n in range(FOUNDERS)
    ]


def check_founders(servers: Sequence[Server], founders: Sequence[Founder]) -> None:
    """Check that each session that was answered is there, once, and that no other is."""
    asyncio.run(_ask_all_again(founders))
    told = {
        f"{founder.name}-{number}": json.loads(one.body)["id"]
        for founder in founders
        for number, one in enumerate(founder.answered)
    }
    for server in servers:
        listed = [one for one in read_sessions(server) if one["name"].startswith("founder-")]
        assert {one["name"]: one["id"] for one in listed} == told
        assert len(listed) == len(told), "a session was begun twice"


def check(servers: Sequence[Server], robots: Sequence[Robot]) -> None:
    """Check all sessions: nothing lost, doubled, or out of order; the maps are as they must be."""
    asyncio.run(_ask_all_again(robots))
    for session in {robot.session for robot in robots}:
        mine = [robot for robot in robots if robot.session == session]
        check_session(servers, session, mine)


async def _ask_all_again(clients: Sequence[Stubborn]) -> None:
    async with httpx2.AsyncClient(timeout=60) as http:
        for client in clients:
            for number in range(max(0, len(client.answered) - 3), len(client.answered)):
                await client.ask_again(http, number)


def check_session(servers: Sequence[Server], session: str, robots: Iterable[Robot]) -> None:
    """Hold the log of a session against what its robots were told, and against the map."""
    log = read_log(servers[0], session)
    assert [one["seq"] for one in log] == list(range(1, len(log) + 1)), "a gap"
    told: dict[int, bytes] = {}
    for robot in robots:
        seqs = [one.seq for one in robot.answered]
        assert seqs == sorted(set(seqs)), "a robot's steps are out of order, or two are one"
        assert not told.keys() & seqs, "two robots were told the same number"
        told |= {one.seq: one.body for one in robot.answered}
        for number, one in enumerate(robot.answered):
            assert log[one.seq - 1]["input"]["pose"] == STEPS[number % len(STEPS)]["pose"]
            assert one.tag.endswith(f'-{one.seq}"')
    assert sorted(told) == [one["seq"] for one in log], "a step was lost or doubled"
    assert [json.loads(told[one["seq"]]) for one in log] == [one["answer"] for one in log]
    check_map(servers, session, log)


def check_map(servers: Sequence[Server], session: str, log: list[dict[str, Any]]) -> None:
    """Hold a map, now and earlier, by every server, against what the library makes of the log."""
    twin = Twin.driven(SESSION, [one["input"] for one in log])
    assert [untimed(one["answer"]) for one in log] == twin.answers
    for server in servers:
        assert server.get(f"{session}/zones") == twin.zones()
        assert server.get(f"{session}/graph") == twin.graph()
        for seq in (len(log) // 3, max(0, len(log) - 1)):
            assert server.get(f"{session}/zones", at=seq) == twin.zones(seq)


def read_log(server: Server, session: str) -> list[dict[str, Any]]:
    """Return all of a session's log, page by page."""
    log: list[dict[str, Any]] = []
    after: int | None = 0
    while after is not None:
        page = json.loads(server.get(f"{session}/steps", after=after, limit=1000))
        log += page["steps"]
        after = page["next"]
    return log


def read_sessions(server: Server) -> list[dict[str, Any]]:
    """Return all sessions, page by page."""
    sessions: list[dict[str, Any]] = []
    following: dict[str, Any] = {"limit": 1000}
    while following:
        page = json.loads(server.get("/sessions", **following))
        sessions += page["sessions"]
        following = {"limit": 1000, "cursor": page["next"]} if page["next"] else {}
    return sessions
