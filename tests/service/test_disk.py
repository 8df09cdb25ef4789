"""A disk that is full, a file that is locked: 503, nothing lost, and it goes on by itself."""

from __future__ import annotations

import asyncio
import os
import resource
import sqlite3
import subprocess
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Protocol

import pytest

from tests.crash import assert_whole
from tests.robots import Robot, check, make_robots
from tests.servers import Server
from tests.service.twin import at, paper_steps, paper_world

ROOM = 300_000  # B, from when on there is none; less than what SQLite puts into its log

needs_prlimit = pytest.mark.skipif(not hasattr(resource, "prlimit"), reason="needs prlimit (Linux)")


class Shortage(Protocol):
    """A server whose disk can become full, and free again."""

    server: Server

    def begin(self) -> None:
        """Leave little room from now on."""

    def end(self) -> None:
        """Make room again."""


class SmallFiles:
    """No file may grow beyond a size (RLIMIT_FSIZE)."""

    def __init__(self, folder: Path) -> None:
        """Run a server."""
        self.server = Server(folder / "server")
        self.server.start()

    def begin(self) -> None:
        """Leave little room from now on."""
        log = self.server.database.with_name("semtopo.db-wal")
        self._limit(log.stat().st_size + ROOM)

    def end(self) -> None:
        """Make room again."""
        self._limit(resource.RLIM_INFINITY)

    def _limit(self, size: int) -> None:
        limits = (size, resource.RLIM_INFINITY)
        resource.prlimit(self.server.pid, resource.RLIMIT_FSIZE, limits)


class SmallDisk:
    """The database has a small disk of its own (tmpfs), which only root can give it."""

    def __init__(self, folder: Path) -> None:
        """Run a server."""
        self._disk = folder / "disk"
        self.server = Server(folder / "server", f"sqlite:///{self._disk / 'semtopo.db'}")
        self.server.start()

    def begin(self) -> None:
        """Leave little room from now on."""
        used = sum(file.stat().st_size for file in self._disk.iterdir())
        self._resize(used + ROOM)

    def end(self) -> None:
        """Make room again."""
        self._resize(100_000_000)

    def _resize(self, size: int) -> None:
        remount = ["mount", "-o", f"remount,size={size}", str(self._disk)]
        subprocess.run(remount, check=True)


@contextmanager
def mounted(place: Path) -> Iterator[bool]:
    """Put a disk of 100 MB in a place, if we may; say whether we might."""
    place.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=100m", "none", str(place)]
    may = os.geteuid() == 0 and subprocess.run(mount, check=False).returncode == 0
    try:
        yield may
    finally:
        if may:
            subprocess.run(["umount", str(place)], check=True)


async def _until(happened: Callable[[], bool]) -> None:
    async with asyncio.timeout(60):
        while not happened():  # noqa: ASYNC110 -- what happens is in other processes
            await asyncio.sleep(0.05)


async def drive_through(shortage: Shortage, robots: list[Robot]) -> int:
    """Let robots drive until the disk is full, and for a while after; return how far they came."""
    stop = asyncio.Event()

    def answered() -> int:
        return sum(len(robot.answered) for robot in robots)

    async with asyncio.TaskGroup() as tasks:
        for robot in robots:
            tasks.create_task(robot.drive(stop))
        await _until(lambda: answered() > 30)
        shortage.begin()
        await _until(lambda: all(robot.refused > 1 for robot in robots))
        when_full = answered()
        for session in {robot.session for robot in robots}:
            assert await asyncio.to_thread(shortage.server.get, f"{session}/zones")
        assert shortage.server.client.get("/readyz").status_code == 200
        shortage.end()
        await _until(lambda: answered() > when_full + 60)
        stop.set()
    return when_full


def drive_and_check(shortage: Shortage) -> None:
    server = shortage.server
    try:
        robots = make_robots([server], seed=1)
        when_full = asyncio.run(drive_through(shortage, robots))
        assert 30 < when_full < sum(len(robot.answered) for robot in robots)
        check([server], robots)
        assert server.faults() == []
    finally:
        shortage.end()
        server.close()
    assert_whole(server.database)


@needs_prlimit
def test_files_that_may_not_grow(tmp_path: Path) -> None:
    drive_and_check(SmallFiles(tmp_path))


def test_a_disk_that_is_full(tmp_path: Path) -> None:
    with mounted(tmp_path / "disk") as may:
        if not may:
            pytest.skip("only root may mount a small disk")
        drive_and_check(SmallDisk(tmp_path))


@needs_prlimit
def test_a_server_killed_on_a_full_disk(tmp_path: Path) -> None:
    """What was answered is there, though the last of what was written is half a step."""
    shortage = SmallFiles(tmp_path)
    server = shortage.server
    path = server.create(world=paper_world())
    shortage.begin()
    bodies, refused = [], 0
    for document in paper_steps() * 4:
        answer = server.client.post(f"{path}/step", json=document)
        if answer.status_code == 503:
            refused += 1
            break
        bodies.append(answer.json())
    assert refused
    server.restart()
    logged = server.client.get(f"{path}/steps", params={"limit": 1000}).json()["steps"]
    assert [one["answer"] for one in logged] == bodies
    assert server.step(path, at(1, 6))["seq"] == len(bodies) + 1
    server.close()
    assert server.faults() == []
    assert_whole(server.database)


def test_a_file_that_another_process_holds(own_server: Server) -> None:
    own_server.start()
    path = own_server.create(world=paper_world())
    other = sqlite3.connect(own_server.database, isolation_level=None)
    other.execute("BEGIN IMMEDIATE")
    answer = own_server.client.post(f"{path}/step", json=at(1, 6))
    assert (answer.status_code, answer.json()["code"]) == (503, "storage_unavailable")
    assert answer.headers["Retry-After"] == "1"
    assert own_server.get(f"{path}/zones")
    other.execute("ROLLBACK")
    other.close()
    assert own_server.step(path, at(1, 6))["seq"] == 1
