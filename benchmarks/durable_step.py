"""What a durable step costs over HTTP, beside a bare endpoint that commits one row of 1 KB.

What the map itself computes is left out (a step finds nothing, at once), or taken off (by the
`timings_ms` of each answer): what remains is HTTP, validation, order, the log and the commit. All
servers are loaded in turn, several rounds, in one run; the ratios are what counts. Run it alone as
`python -m benchmarks durable_step`.
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
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass

import orjson

from benchmarks.load import HOST, Load, exchange, request_bytes, run
from benchmarks.table import Row, Table

ROUNDS = 7
COUNT = {1: 1_000, 16: 3_000}
SESSIONS = 16
BARE = """
import gc, uvicorn
from benchmarks.bare import create_app
app = create_app(); gc.collect(); gc.freeze()
uvicorn.run(app, port={port}, access_log=False, log_level="warning")
"""

_SEMTOPO = """
import logging, os
from service.app import serve
from service.settings import Settings
CHANGE
serve(Settings(port={port}, database="sqlite:///" + os.environ["STEP_DATABASE"]))
"""

SILENT = "logging.disable(logging.INFO)"

SEMTOPO = _SEMTOPO.replace("CHANGE", SILENT)
"""A server without a log of requests."""

STILL = """
from dataclasses import replace
from semtopo import Stage, Step
from service.hot import HotSession
def take(hot, pose, seen, watch):
    for stage in Stage:
        watch.ended(stage)
    state = replace(hot.state, seq=hot.state.seq + 1, position=pose.position)
    return Step(state, None, ())
HotSession.take = take
"""
"""Leaves the map's computing out, and with it that the processor's caches forget the rest."""


@dataclass(frozen=True, slots=True)
class Subject:
    """A server, and what is asked of it."""

    who: str
    code: str
    path: str = ""
    computes: bool = False
    """Whether what the map took is to be taken off."""


YARDSTICK = Subject("bare, on a thread", BARE, "/thread")

SUBJECTS = [
    Subject("steps, computing left out", _SEMTOPO.replace("CHANGE", SILENT + STILL)),
    Subject("steps, computing taken off", SEMTOPO, computes=True),
    Subject("the same, requests logged", _SEMTOPO.replace("CHANGE", ""), computes=True),
    YARDSTICK,
    Subject("bare, on the event loop", BARE, "/loop"),
]


@contextmanager
def server(code: str, environment: dict[str, str]) -> Iterator[int]:
    """Run a server in a process of its own, and give its port."""
    with socket.socket() as free:
        free.bind((HOST, 0))
        port: int = free.getsockname()[1]
    command = [sys.executable, "-c", code.format(port=port)]
    with subprocess.Popen(  # noqa: S603 -- ourselves
        command, env={**os.environ, **environment}, stderr=subprocess.DEVNULL
    ) as process:
        for _ in range(2_400):
            if process.poll() is not None:
                raise RuntimeError("the server ended")
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
    """Load all servers in turn; return the loads by who was asked and number of clients."""
    found: dict[tuple[str, int], list[Load]] = {}
    with ExitStack() as ending:
        asked = [_begun(subject, ending) for subject in SUBJECTS]
        for _ in range(ROUNDS):
            for clients, count in COUNT.items():
                for subject, port, requests in asked:
                    off = computing if subject.computes else None
                    load = run(port, requests, clients=clients, count=count, taken_off=off)
                    found.setdefault((subject.who, clients), []).append(load)
    return found


def _begun(subject: Subject, ending: ExitStack) -> tuple[Subject, int, Callable[[int], bytes]]:
    """Return a subject, the port of its server, and the requests that it gets."""
    folder = ending.enter_context(tempfile.TemporaryDirectory())
    files = {"BARE_DATABASE": f"{folder}/bare.db", "STEP_DATABASE": f"{folder}/step.db"}
    port = ending.enter_context(server(subject.code, files))
    if subject.path:
        row = orjson.dumps({"pose": {"x": 1.0, "y": 6.0}, "text": "x" * 960})
        request = request_bytes("POST", subject.path, row)
        return subject, port, lambda _: request
    ids = asyncio.run(make_sessions(port))
    steps = [request_bytes("POST", f"/sessions/{one}/step", step_body()) for one in ids]
    return subject, port, lambda number: steps[number % SESSIONS]


def tables() -> Iterator[Table]:
    """Yield medians over the rounds, the first left out."""
    found = measure()
    for clients in COUNT:
        loads = {it.who: found[it.who, clients][1:] for it in SUBJECTS}
        yield f"A durable step over HTTP without the map, {clients} clients", _rows(loads)


def _rows(loads: dict[str, list[Load]]) -> list[Row]:
    figures = {
        (who, share): statistics.median(it.percentile(share) for it in rounds)
        for who, rounds in loads.items()
        for share in (0.5, 0.99)
    }
    return [
        {
            "who": who,
            "a second": f"{statistics.median(it.rate for it in rounds):.0f}",
            **{f"p{100 * share:.0f}, ms": f"{figures[who, share]:.2f}" for share in (0.5, 0.99)},
            **{
                f"p{100 * share:.0f} / bare, on a thread":
                    f"{figures[who, share] / figures[YARDSTICK.who, share]:.2f}"
                for share in (0.5, 0.99)
            },
        }
        for who, rounds in loads.items()
    ]  # fmt: skip
