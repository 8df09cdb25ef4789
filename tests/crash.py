"""Kill what serves or stores, at random, while robots drive; then check that nothing went wrong.

    python -m tests.crash --kills 200 [--on sqlite|...] [--seed 1]

Sixteen robots take steps in eight sessions, two in each, and two founders begin more sessions.
Meanwhile processes are killed (-9) and started again. At the end, every answered step must stand in
the log once, in order and with that answer, and the map must be what the library makes of the log;
see `robots.check`.
"""

from __future__ import annotations

import argparse
import asyncio
import random
import sqlite3
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Protocol

from tests.postgres import running_postgres
from tests.robots import (
    Founder,
    Robot,
    Stubborn,
    check,
    check_founders,
    make_founders,
    make_robots,
)
from tests.servers import Server

BETWEEN_KILLS = (0.05, 0.8)  # s, drawn anew each time, so that kills fall anywhere in a step


class On(StrEnum):
    """What there is, and what of it is killed."""

    SQLITE = "sqlite"  # a server on a SQLite file; the server is killed
    SQLITE_STOPPED = "sqlite-stopped"  # the same, but the server is asked to end (SIGTERM)
    SQLITE_TWO = "sqlite-two"  # two servers on a SQLite file; either is killed
    POSTGRES = "postgres"  # two servers on PostgreSQL; either is killed
    POSTGRES_ITSELF = "postgres-itself"  # two servers on PostgreSQL, which is killed


class Victim(Protocol):
    """A process that can be killed and started again."""

    def kill(self) -> None:
        """End it at once."""

    def start(self) -> None:
        """Start it, and wait until it answers."""


@dataclass(frozen=True, slots=True)
class Asked:
    """A server that is asked to end, rather than killed; it must do so in order."""

    server: Server

    def kill(self) -> None:
        """Ask it to end."""
        self.server.stop()

    def start(self) -> None:
        """Start it, and wait until it answers."""
        self.server.start()


@dataclass(frozen=True, slots=True)
class Report:
    """What a run of kills came to."""

    robots: Sequence[Robot]
    founders: Sequence[Founder]
    restarts: list[float]
    seconds: float

    @property
    def answered(self) -> int:
        """Steps that were answered."""
        return sum(len(robot.answered) for robot in self.robots)

    @property
    def replayed(self) -> int:
        """Steps whose first answer was lost through a kill alone: taken once, answered again."""
        answers = [one for robot in self.robots for one in robot.answered]
        return sum(one.replayed and not one.hung_up for one in answers)

    @property
    def replayed_after_hanging_up(self) -> int:
        """Steps whose first answer was lost because the robot hung up."""
        answers = [one for robot in self.robots for one in robot.answered]
        return sum(one.replayed and one.hung_up for one in answers)

    def __str__(self) -> str:
        """Return one line."""
        restarts = sorted(self.restarts)
        attempts, hung_up, asked_again = (
            sum(getattr(robot, name) for robot in self.robots)
            for name in ("attempts", "hung_up", "asked_again")
        )
        begun = sum(len(founder.answered) for founder in self.founders)
        return (
            f"{len(restarts)} kills in {self.seconds:.0f} s; {self.answered} steps answered in"
            f" {attempts} attempts, of which {hung_up} hung up; first answer lost and repeated:"
            f" {self.replayed} by a kill, {self.replayed_after_hanging_up} after hanging up;"
            f" {asked_again} asked again; 0 lost, 0 doubled, 0 out of order;"
            f" {begun} sessions begun, 0 lost, 0 doubled;"
            f" restart median {restarts[len(restarts) // 2]:.2f} s, longest {restarts[-1]:.2f} s"
        )


def torment(
    servers: Sequence[Server], victims: Sequence[Victim], kills: int, seed: int
) -> Report:  # fmt: skip
    """Let robots drive while victims are killed; check everything; say what happened."""
    robots, founders = make_robots(servers, seed), make_founders(servers, seed)
    clients: list[Stubborn] = [*robots, *founders]
    begun = time.monotonic()
    restarts = asyncio.run(_drive_and_kill(clients, victims, kills, random.Random(seed)))
    seconds = time.monotonic() - begun
    check(servers, robots)
    check_founders(servers, founders)
    return Report(robots, founders, restarts, seconds)


async def _drive_and_kill(
    clients: Sequence[Stubborn], victims: Sequence[Victim], kills: int, chance: random.Random
) -> list[float]:
    """Return how long each restart took, in s."""
    stop, restarts = asyncio.Event(), []
    async with asyncio.TaskGroup() as tasks:
        for client in clients:
            tasks.create_task(client.drive(stop))
        for number in range(kills):
            await asyncio.sleep(chance.uniform(*BETWEEN_KILLS))
            victim = chance.choice(victims)
            await asyncio.to_thread(victim.kill)
            begun = time.monotonic()
            await asyncio.to_thread(victim.start)
            restarts.append(time.monotonic() - begun)
            if sys.stderr.isatty():
                print(f"\r{number + 1}/{kills} kills", end="", file=sys.stderr)
        await asyncio.sleep(1)
        stop.set()
    return restarts


@contextmanager
def scene(on: On, folder: Path) -> Iterator[tuple[list[Server], list[Victim]]]:
    """Give running servers on one database, and those processes that are to be killed."""
    with ExitStack() as ending:
        one, victims = Server(folder / "one"), list[Victim]()
        servers = [one]
        if on in {On.POSTGRES, On.POSTGRES_ITSELF}:
            postgres = ending.enter_context(running_postgres())
            url = postgres.create("robots")
            servers = [Server(folder / name, url) for name in ("one", "two")]
            victims = [postgres] if on is On.POSTGRES_ITSELF else []
        elif on is On.SQLITE_TWO:
            servers.append(Server(folder / "two", one.url))
        elif on is On.SQLITE_STOPPED:
            victims = [Asked(one)]
        for server in servers:
            ending.callback(server.close)
            server.start()
        yield servers, victims or [*servers]


def run(on: On, kills: int, seed: int, folder: Path) -> Report:
    """Run one torment; raise AssertionError if a promise was broken."""
    with scene(on, folder) as (servers, victims):
        report = torment(servers, victims, kills, seed)
        assert [server.faults() for server in servers] == [[]] * len(servers)
    if servers[0].database.exists():
        assert_whole(servers[0].database)
    return report


def assert_whole(database: Path) -> None:
    """Let SQLite check a file that nobody has open."""
    with sqlite3.connect(database) as connection:
        found = connection.execute("PRAGMA integrity_check").fetchall()
        found += connection.execute("PRAGMA foreign_key_check").fetchall()
    connection.close()
    assert found == [("ok",)]


def main() -> None:
    """Run as a command."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--kills", type=int, default=20)
    parser.add_argument("--on", choices=list(On), type=On, default=On.SQLITE)
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        report = run(given.on, given.kills, given.seed, Path(folder))
    print(f"{given.on}: {report}", flush=True)


if __name__ == "__main__":
    main()
