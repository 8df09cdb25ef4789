"""Robots that never give up, a server that is killed at random, and what must hold afterwards.

    python -m tests.crash --kills 200 [--on sqlite|postgres|postgres-itself] [--seed 1]

Sixteen robots take steps in eight sessions, two in each; every step has an Idempotency-Key, and is
sent until it is answered. Meanwhile processes are killed (-9) and started again. At the end, every
answered step must stand in the log once, in order and with that answer, and the map must be what
the library makes of the log.
"""

from __future__ import annotations

import argparse
import asyncio
import json
import random
import sqlite3
import tempfile
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any, Literal, Protocol

import httpx2

from semtopo import PoseDocument, WorldDocument, scan_world, step
from semtopo.codec import graph_body, zones_body
from semtopo.mapper import MapState
from semtopo.sensor import Sensor
from semtopo.types import MappingOptions, Point
from tests.postgres import running_postgres
from tests.servers import Server

SESSIONS, ROBOTS = 8, 16
PAPER = Path(__file__).parents[1] / "examples" / "paper"
BETWEEN_KILLS = (0.05, 0.8)  # s, drawn anew each time, so that kills fall anywhere in a step
STEP_SECONDS_MAX = 120.0
On = Literal["sqlite", "postgres", "postgres-itself"]


class Victim(Protocol):
    """A process that can be killed and started again."""

    def kill(self) -> None:
        """End it at once."""

    def start(self) -> None:
        """Start it, and wait until it answers."""


class SharedServer(Server):
    """A server on a database that others use too."""

    def __init__(self, folder: Path, url: str, **settings: object) -> None:
        """Choose a port; nothing runs yet."""
        super().__init__(folder, **settings)
        self._url = url

    @property
    def url(self) -> str:
        """The database as SQLAlchemy writes it."""
        return self._url


@dataclass(frozen=True, slots=True)
class Answered:
    """A step that was answered: its key, the body of the answer, and whether it was a repeat."""

    key: str
    body: bytes
    replayed: bool


@dataclass(slots=True)
class Robot:
    """Takes steps in one session, one after the other, and remembers the answers."""

    name: str
    session: str
    ports: list[int]
    path: list[Point]
    chance: random.Random
    answered: list[Answered] = field(default_factory=list)
    attempts: int = 0

    async def drive(self, stop: asyncio.Event) -> None:
        """Take steps until told to stop; the one begun is brought to its end."""
        async with httpx2.AsyncClient(timeout=10) as client:
            while not stop.is_set():
                number = len(self.answered)
                x, y = self.path[number % len(self.path)]
                self.answered.append(
                    await self._until_answered(client, f"{self.name}-{number}", x, y)
                )

    async def _until_answered(
        self, client: httpx2.AsyncClient, key: str, x: float, y: float
    ) -> Answered:
        give_up = time.monotonic() + STEP_SECONDS_MAX
        while time.monotonic() < give_up:
            port = self.chance.choice(self.ports)
            url = f"http://127.0.0.1:{port}{self.session}/step"
            self.attempts += 1
            try:
                answer = await client.post(
                    url, json={"pose": {"x": x, "y": y}}, headers={"Idempotency-Key": key}
                )
            except httpx2.TransportError:
                await asyncio.sleep(0.02)
                continue
            if answer.status_code == 201:
                replayed = answer.headers.get("Idempotency-Replayed") == "true"
                return Answered(key, answer.content, replayed)
            assert answer.status_code == 503, (answer.status_code, answer.text)
            await asyncio.sleep(0.05)
        raise AssertionError(f"{key} was not answered")


@dataclass(frozen=True, slots=True)
class Report:
    """What a run of kills came to."""

    kills: int
    answered: int
    attempts: int
    replayed: int
    restarts: list[float]

    def __str__(self) -> str:
        """Return one line."""
        restarts = sorted(self.restarts)
        return (
            f"{self.kills} kills, {self.answered} steps answered in {self.attempts} attempts,"
            f" {self.replayed} answers repeated; 0 lost, 0 doubled, 0 out of order;"
            f" restart median {restarts[len(restarts) // 2]:.2f} s, greatest {restarts[-1]:.2f} s"
        )


def paper_path() -> list[Point]:
    """Return the positions of the example's path, in m."""
    lines = (PAPER / "path.csv").read_text().split()[1:]
    return [(float(x), float(y)) for x, y in (line.split(",") for line in lines)]


def torment(servers: list[Server], victims: list[Victim], kills: int, seed: int) -> Report:
    """Let robots drive while victims are killed; check everything; say what happened."""
    world = json.loads((PAPER / "world.json").read_text())
    sensor = {"beams": 36, "range": 2.0, "samples": 20}
    sessions = [servers[0].create(world=world, sensor=sensor) for _ in range(SESSIONS)]
    chance = random.Random(seed)
    ports, path = [server.port for server in servers], paper_path()
    robots = [
        Robot(f"robot-{n}", sessions[n % SESSIONS], ports, path, random.Random(seed + n))
        for n in range(ROBOTS)
    ]
    restarts = asyncio.run(_drive_and_kill(robots, victims, kills, chance))
    for session in sessions:
        check(servers[0], session, [robot for robot in robots if robot.session == session])
    answers = [one for robot in robots for one in robot.answered]
    return Report(
        kills=kills,
        answered=len(answers),
        attempts=sum(robot.attempts for robot in robots),
        replayed=sum(one.replayed for one in answers),
        restarts=restarts,
    )


async def _drive_and_kill(
    robots: list[Robot], victims: list[Victim], kills: int, chance: random.Random
) -> list[float]:
    """Return how long each restart took, in s."""
    stop = asyncio.Event()
    async with asyncio.TaskGroup() as tasks:
        for robot in robots:
            tasks.create_task(robot.drive(stop))
        restarts = []
        for _ in range(kills):
            await asyncio.sleep(chance.uniform(*BETWEEN_KILLS))
            victim = chance.choice(victims)
            victim.kill()
            begun = time.monotonic()
            await asyncio.to_thread(victim.start)
            restarts.append(time.monotonic() - begun)
        await asyncio.sleep(1)
        stop.set()
    return restarts


def check(server: Server, session: str, robots: list[Robot]) -> None:
    """Hold the log of a session against what its robots were answered, and against the map."""
    log = read_log(server, session)
    assert [one["seq"] for one in log] == list(range(1, len(log) + 1))
    place = {json.dumps(one["answer"]): one["seq"] for one in log}
    answered = [one for robot in robots for one in robot.answered]
    assert len(log) == len(answered), "a step was lost or doubled"
    for robot in robots:
        seqs = [place[json.dumps(json.loads(one.body))] for one in robot.answered]
        assert seqs == sorted(set(seqs)), "a robot's steps are out of order"
        assert [json.loads(one.body)["seq"] for one in robot.answered] == seqs
        for seq, (x, y) in zip(seqs, _cycled(robot.path), strict=False):
            pose = log[seq - 1]["input"]["pose"]
            assert (pose["x"], pose["y"]) == (x, y)
    state = replay(log)
    assert server.get(f"{session}/zones") == zones_body(state)
    assert server.get(f"{session}/graph") == graph_body(state.graph, state.seq)


def read_log(server: Server, session: str) -> list[dict[str, Any]]:
    """Return all of a session's log, page by page."""
    log: list[dict[str, Any]] = []
    after = 0
    while True:
        page = json.loads(server.get(f"{session}/steps", after=after, limit=1000))
        log += page["steps"]
        if page["next"] is None:
            return log
        after = page["next"]


def replay(log: list[dict[str, Any]]) -> MapState:
    """Return the map that the library makes of a log."""
    world = WorldDocument.model_validate_json((PAPER / "world.json").read_bytes()).value()
    sensor, state = Sensor(36, 2.0, 20), MapState()
    for one in log:
        pose = PoseDocument.model_validate(one["input"]["pose"]).value()
        state = step(state, scan_world(world, sensor, pose.position), MappingOptions()).state
    return state


def _cycled(path: list[Point]) -> Iterator[Point]:
    while True:
        yield from path


@contextmanager
def scene(on: On, folder: Path) -> Iterator[tuple[list[Server], list[Victim]]]:
    """Give running servers on one database, and those processes that are to be killed."""
    with ExitStack() as ending:
        victims: list[Victim]
        if on == "sqlite":
            servers = [Server(folder)]
            victims = [*servers]
        else:
            postgres = ending.enter_context(running_postgres())
            url = postgres.create("robots")
            places = [folder / name for name in ("one", "two")]
            for place in places:
                place.mkdir()
            servers = [SharedServer(place, url) for place in places]
            victims = [postgres] if on == "postgres-itself" else [*servers]
        for server in servers:
            server.start()
            ending.callback(server.close)
        yield servers, victims


def run(on: On, kills: int, seed: int, folder: Path) -> Report:
    """Run one torment; raise AssertionError if a promise was broken."""
    with scene(on, folder) as (servers, victims):
        report = torment(servers, victims, kills, seed)
        if on == "sqlite":
            servers[0].stop()
            with sqlite3.connect(servers[0].database) as connection:
                found = connection.execute("PRAGMA integrity_check").fetchall()
            assert found == [("ok",)]
    return report


def main() -> None:
    """Run as a command."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kills", type=int, default=20)
    parser.add_argument("--on", choices=("sqlite", "postgres", "postgres-itself"), default="sqlite")
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        report = partial(run, given.on, given.kills, given.seed)(Path(folder))
    print(given.on + ":", report)


if __name__ == "__main__":
    main()
