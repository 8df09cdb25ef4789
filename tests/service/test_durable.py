"""What was answered is on disk: seen from below, by the calls that the server makes."""

from __future__ import annotations

import re
import shutil
import signal
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from service import store
from service.database import open_database
from tests.servers import Server
from tests.service.twin import paper_steps, paper_world

STEPS = 30
CALLS = "pwrite64,fsync,fdatasync,write,writev,sendto,sendmsg"
BEGUN = re.compile(r"^(?P<thread>\d+) +(?P<call>\w+)\(\d+<(?P<file>[^>]*)>(?P<rest>.*)$")
RESUMED = re.compile(r"^(?P<thread>\d+) +<\.\.\. (?P<call>\w+) resumed>.* = 0$")


@contextmanager
def traced(server: Server, trace: Path) -> Iterator[None]:
    """Write down what the server asks of the system, with the files' names."""
    strace = shutil.which("strace")
    if strace is None:
        pytest.skip("needs strace")
    command = [strace, "-f", "-y", "-s", "40", "-e", CALLS, "-o", str(trace), "-p", str(server.pid)]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as process:
        assert process.stderr is not None
        first = process.stderr.readline()
        if "attached" not in first:
            pytest.skip(f"strace may not look: {first}")
        yield
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=30)


def events(trace: Path, database: Path) -> Iterator[tuple[str, str]]:
    """Yield in order what is written to a file, what has reached the disk, and what is answered."""
    syncing: dict[str, str] = {}  # by thread
    for line in trace.read_text().splitlines():
        resumed, begun = RESUMED.match(line), BEGUN.match(line)
        if resumed and resumed["thread"] in syncing:
            yield "on disk", syncing.pop(resumed["thread"])
        elif begun and "HTTP/1.1 201" in begun["rest"]:
            yield "answered", ""
        elif begun and re.fullmatch(rf"{database}(-wal|-journal)?", begun["file"]):
            if begun["call"] == "pwrite64":
                yield "written", begun["file"]
            elif begun["rest"].endswith("= 0"):
                yield "on disk", begun["file"]
            else:
                syncing[begun["thread"]] = begun["file"]


def test_a_step_is_on_disk_before_it_is_answered(own_server: Server, tmp_path: Path) -> None:
    own_server.start()
    path, trace = own_server.create(world=paper_world()), tmp_path / "trace"
    with traced(own_server, trace):
        for document in paper_steps()[:STEPS]:
            own_server.step(path, document)
        time.sleep(0.2)
    dirty, written, answered = set(), 0, 0
    for what, file in events(trace, own_server.database):
        if what == "written":
            dirty.add(file)
            written += 1
        elif what == "on disk":
            dirty.discard(file)
        else:
            answered += 1
            assert written > 0, f"step {answered} was answered before it was written"
            assert not dirty, f"step {answered} was answered before it was on disk"
            written = 0
    assert answered == STEPS


def test_a_step_writes_no_world(tmp_path: Path) -> None:
    """SQLite writes a row as a whole where its size changes, as a growing number does."""
    grown = {}
    for size in (100, 1_000_000):
        file = tmp_path / f"{size}.db"
        database = open_database(f"sqlite:///{file}")
        new = store.NewSession("id", "name", "2026", "w" * size, "{}", "{}", "0")
        with database.writer.begin() as connection:
            session = store.add_session(connection, new)
        log = file.with_name(f"{file.name}-wal")
        before = log.stat().st_size
        for version in range(130):
            with database.writer.begin() as connection:
                assert store.advance(connection, session, version)
        grown[size] = log.stat().st_size - before
        database.close()
    assert grown[100] == grown[1_000_000] > 0
