"""What a durable step costs over HTTP, beside a bare endpoint that commits one row of 1 KB.

What the map itself computes (`timings_ms` of each answer) is taken off: what remains is HTTP,
validation, order, the log and the commit. All servers are loaded in turn, several rounds, in one
run; the ratios are what counts. Run it alone as `python -m benchmarks
durable_step`.
"""

from __future__ import annotations

import asyncio
import os
import socket
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import orjson

from benchmarks.load import HOST, Load, exchange, request_bytes, run
from benchmarks.table import Row, Table

ROUNDS = 7
COUNT = {1: 1_000, 16: 3_000}
SESSIONS = 16
NAMES = {"semtopo": "semtopo", "thread": "bare, on a thread", "loop": "bare, on the event loop"}

BARE = """
import gc, uvicorn
from benchmarks.bare import create_app
app = create_app(); gc.collect(); gc.freeze()
uvicorn.run(app, port={port}, access_log=False, log_level="warning")
"""

SEMTOPO = """
import logging, os
from service.app import serve
from service.settings import Settings
logging.disable(logging.INFO)
serve(Settings(port={port}, database="sqlite:///" + os.environ["STEP_DATABASE"]))
"""


@contextmanager
def server(code: str, environment: dict[str, str]) -> Iterator[int]:
    """Run a server in a process of its own, and give its port."""
    with socket.socket() as free:
        free.bind((HOST, 0))
        port: int = free.getsockname()[1]
    command = [sys.executable, "-c", code.format(port=port)]
    with subprocess.Popen(command, env={**os.environ, **environment}) as process:  # noqa: S603 -- ourselves
        for _ in range(400):
            with socket.socket() as probe:
                if probe.connect_ex((HOST, port)) == 0:
                    break
            time.sleep(0.05)
        yield port
        process.terminate()


async def make_sessions(port: int) -> list[str]:
    """Begin sessions without a world, and return their ids."""
    reader, writer = await asyncio.open_connection(HOST, port)
    request = request_bytes("POST", "/sessions", b"{}")
    answers = [await exchange(reader, writer, request) for _ in range(SESSIONS)]
    writer.close()
    return [orjson.loads(body)["id"] for _, body in answers]


def computing(body: bytes) -> float:
    """Return how long the map was computed for an answer, in ms."""
    took: float = orjson.loads(body)["timings_ms"]["total"]
    return took


def step_body() -> bytes:
    """Return a step with a scan that saw nothing, about 1 KB."""
    kinds = {f"a label of thirty characters {number:02}": "space" for number in range(22)}
    scan = {"angle_min": 0.0, "angle_increment": 0.1, "range_max": 2.0, "beams": [], "kinds": kinds}
    return orjson.dumps({"pose": {"x": 1.0, "y": 6.0}, "scan": scan})


def measure() -> dict[tuple[str, int], list[Load]]:
    """Load all servers in turn; return the loads by name and number of clients."""
    found: dict[tuple[str, int], list[Load]] = {}
    row = orjson.dumps({"pose": {"x": 1.0, "y": 6.0}, "text": "x" * 960})
    with tempfile.TemporaryDirectory() as folder:
        files = {"BARE_DATABASE": f"{folder}/bare.db", "STEP_DATABASE": f"{folder}/step.db"}
        with server(BARE, files) as bare, server(SEMTOPO, files) as semtopo:
            ids = asyncio.run(make_sessions(semtopo))
            steps = [request_bytes("POST", f"/sessions/{one}/step", step_body()) for one in ids]
            kinds: dict[str, tuple[int, Callable[[int], bytes]]] = {
                "semtopo": (semtopo, lambda number: steps[number % SESSIONS]),
                "thread": (bare, lambda _: request_bytes("POST", "/thread", row)),
                "loop": (bare, lambda _: request_bytes("POST", "/loop", row)),
            }
            for _ in range(ROUNDS):
                for clients, count in COUNT.items():
                    for name, (port, requests) in kinds.items():
                        off = computing if name == "semtopo" else None
                        load = run(port, requests, clients=clients, count=count, taken_off=off)
                        found.setdefault((name, clients), []).append(load)
    return found


def tables() -> Iterator[Table]:
    """Yield medians over the rounds, the first left out."""
    found = measure()
    for clients in COUNT:
        loads = {name: found[name, clients][1:] for name in ("semtopo", "thread", "loop")}
        yield f"A durable step over HTTP without the map, {clients} clients", _rows(loads)


def _rows(loads: dict[str, list[Load]]) -> list[Row]:
    rates = {name: statistics.median(it.rate for it in rounds) for name, rounds in loads.items()}
    figures = {
        (name, share): statistics.median(it.percentile(share) for it in rounds)
        for name, rounds in loads.items()
        for share in (0.5, 0.99)
    }
    return [
        {
            "who": NAMES[name], "a second": f"{rates[name]:.0f}",
            **{f"p{100 * share:.0f}, ms": f"{figures[name, share]:.2f}" for share in (0.5, 0.99)},
            **{
                f"semtopo / this, p{100 * share:.0f}":
                    f"{figures['semtopo', share] / figures[name, share]:.2f}"
                for share in (0.5, 0.99)
            },
        }
        for name in loads
    ]  # fmt: skip
