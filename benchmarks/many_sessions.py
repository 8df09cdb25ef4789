"""Ten thousand sessions in one process: memory is to stay flat, and steps are to stay fast.

The sessions have no world; each step brings a small scan of a hall, a door and a room. Steps go
over all sessions in turn, so nearly every one finds its map on disk and not in memory. Run it
alone as `python -m benchmarks many_sessions`.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import orjson

from benchmarks.load import Load, request_bytes, run
from benchmarks.memory import held_mb
from benchmarks.table import Row, Table
from tests.servers import Server

SESSIONS = 10_000
STEPS = 100_000
SCAN = {
    "angle_min": 0.0, "angle_increment": 1.5, "range_max": 4.0,
    "beams": [[["hall", 1.0], ["door", 1.2], ["room", 3.0]]] * 4,
    "kinds": {"door": "passage"},
}  # fmt: skip
SHARES = (0, 0.1, 0.3, 0.5, 0.7, 0.9, 1)
"""Shares of all steps after which to report."""

CLIENTS = 16


def take_steps(server: Server, paths: list[str], numbers: range) -> Load:
    """Take steps over all sessions in turn; each visit to a session is 0.25 m further on."""

    def post(number: int) -> bytes:
        visit, session = divmod(numbers[number], len(paths))
        pose = {"x": 0.25 * visit, "y": 0.0, "theta": 0.0}
        body = orjson.dumps({"pose": pose, "scan": SCAN})
        return request_bytes("POST", f"{paths[session]}/step", body)

    return run(server.port, post, clients=CLIENTS, count=len(numbers))


def tables() -> Iterator[Table]:
    """Begin sessions, take steps, and yield what was found now and then."""
    with tempfile.TemporaryDirectory() as folder:
        server = Server(Path(folder))
        server.start()
        rows = [_row(server, "the server has started")]
        paths = [server.create() for _ in range(SESSIONS)]
        rows.append(_row(server, "all sessions have begun"))
        for first, last in pairwise(int(share * STEPS) for share in SHARES):
            load = take_steps(server, paths, range(first, last))
            rows.append(_row(server, f"{last:,} steps", load))
        server.close()
    yield f"{SESSIONS:,} sessions in one process, {CLIENTS} clients", rows


def _row(server: Server, when: str, load: Load | None = None) -> Row:
    stored = server.database.stat().st_size / 1e6
    return {
        "after": when, "MB": f"{held_mb(server):.0f}",
        "steps a second": "" if load is None else f"{load.rate:.0f}",
        "p50, ms": "" if load is None else f"{load.percentile(0.5):.1f}",
        "p99, ms": "" if load is None else f"{load.percentile(0.99):.1f}",
        "greatest, ms": "" if load is None else f"{load.times[-1]:.0f}",
        "MB on disk": f"{stored:.0f}",
    }  # fmt: skip
