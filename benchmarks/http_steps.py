"""Steps over HTTP: real servers on one database, and where the time of a step goes.

In the paper's world at 72 beams, on SQLite and PostgreSQL, from one session and from eight, with
one process and with two. `together` lets each step of a session go to the other process than the
one before, as behind a balancer that knows no sessions: the process must find out what it missed.
"""

from __future__ import annotations

import re
import statistics
import tempfile
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from pathlib import Path

import orjson

from benchmarks.load import Load, request_bytes, run
from benchmarks.paper import EXAMPLE, path
from benchmarks.table import Row, Table, skipped
from tests.postgres import find_binaries, running_postgres
from tests.servers import Server

ROUNDS = 4
"""Each with new sessions; the first is left out."""

STEPS = 81
LAYOUTS = ((1, 1, "one"), (8, 1, "one"), (1, 2, "together"), (8, 2, "apart"), (8, 2, "together"))
"""Sessions, processes, and how the steps of sessions are dealt out to processes."""

_COUNTED = re.compile(
    r"^(semtopo_commit_seconds_sum|process_cpu_seconds_total) (\S+)$", re.MULTILINE
)


@dataclass
class Found:
    """What some rounds found; times in ms, added up over the steps."""

    loads: list[Load] = field(default_factory=list)
    map_ms: float = 0.0
    commit_ms: float = 0.0
    processor_ms: float = 0.0

    @property
    def steps(self) -> int:
        """How many steps were taken."""
        return sum(len(load.times) for load in self.loads)

    @property
    def mean(self) -> float:
        """How long a step took, as its robot saw it, in ms."""
        return sum(sum(load.times) for load in self.loads) / self.steps


@contextmanager
def servers(folder: Path, count: int, url: str | None = None) -> Iterator[list[Server]]:
    """Run some processes on one database: a file in a folder, unless a URL is given."""
    with ExitStack() as stack:
        running = []
        for _ in range(count):
            server = Server(folder, url)
            stack.callback(server.close)
            server.start()
            running.append(server)
        yield running


def counted(running: list[Server]) -> tuple[float, float]:
    """Return how long transactions, and processors, took until now in all processes, in ms."""
    found = {"semtopo_commit_seconds_sum": 0.0, "process_cpu_seconds_total": 0.0}
    for server in running:
        for name, value in _COUNTED.findall(server.get("/metrics").decode()):
            found[name] += 1000 * float(value)
    return found["semtopo_commit_seconds_sum"], found["process_cpu_seconds_total"]


def take_round(running: list[Server], sessions: int, hands: str, found: Found) -> None:
    """Take the steps of the paper's run in some new sessions at once, and note what that took."""
    world = orjson.loads((EXAMPLE / "world.json").read_bytes())
    targets = [f"{running[0].create(world=world)}/step" for _ in range(sessions)]
    bodies = [orjson.dumps({"pose": {"x": x, "y": y}}) for x, y in path()[:STEPS]]

    def request(number: int) -> bytes:
        turn, session = divmod(number, sessions)
        return request_bytes("POST", targets[session], bodies[turn])

    def port(number: int) -> int:
        turn, session = divmod(number, sessions)
        return running[(session if hands == "apart" else turn) % len(running)].port

    def note(body: bytes) -> float:
        found.map_ms += orjson.loads(body)["timings_ms"]["total"]
        return 0.0

    before = counted(running)
    count = len(bodies) * sessions
    found.loads.append(run(port, request, clients=sessions, count=count, taken_off=note))
    after = counted(running)
    found.commit_ms += after[0] - before[0]
    found.processor_ms += after[1] - before[1]


def idle_ms(server: Server) -> float:
    """Return what a request takes that asks for nothing, in ms."""
    request = request_bytes("GET", "/healthz")
    return run(server.port, lambda _: request, clients=1, count=300, expected=200).percentile(0.5)


def measured(running: list[Server], sessions: int, hands: str) -> Row:
    """Return the row of a table for so many sessions."""
    take_round(running, sessions, hands, Found())
    found = Found()
    for _ in range(ROUNDS - 1):
        take_round(running, sessions, hands, found)
    mine, commit, processor = (
        took / found.steps for took in (found.map_ms, found.commit_ms, found.processor_ms)
    )
    row = {
        "sessions": str(sessions),
        "processes": str(len(running)) + (f", {hands}" if len(running) > 1 else ""),
        "steps a second": f"{statistics.median(it.rate for it in found.loads):.0f}",
    }
    for share in (0.5, 0.99):
        at = statistics.median(load.percentile(share) for load in found.loads)
        row[f"p{100 * share:.0f}, ms"] = f"{at:.2f}"
    row |= {
        "map, ms": f"{mine:.2f}", "transactions, ms": f"{commit:.2f}",
        "processor, ms": f"{processor:.2f}",
    }  # fmt: skip
    shares = ["", "", "", ""]
    if sessions == 1:  # else they overlap
        parts = mine, commit, idle_ms(running[0])
        shares = [f"{it / found.mean:.0%}" for it in (*parts, found.mean - sum(parts))]
    names = "map", "database", "HTTP", "validation, order"
    return row | dict(zip(names, shares, strict=True))


def rows(folder: Path, url: str | None = None) -> list[Row]:
    """Return the rows of one database."""
    found = []
    for count in sorted({processes for _, processes, _ in LAYOUTS}):
        with servers(folder, count, url) as running:
            found += [measured(running, one, by) for one, many, by in LAYOUTS if many == count]
    return found


def tables() -> Iterator[Table]:
    """Yield what steps cost over HTTP, database by database."""
    with tempfile.TemporaryDirectory() as folder:
        yield "Steps over HTTP, SQLite", rows(Path(folder))
    title = "Steps over HTTP, PostgreSQL"
    if find_binaries() is None:
        yield skipped(title, "no PostgreSQL found (a package of the tests brings one)")
        return
    with tempfile.TemporaryDirectory() as folder, running_postgres() as postgres:
        yield title, rows(Path(folder), postgres.create("steps"))
