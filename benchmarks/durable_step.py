"""What a durable step costs over HTTP, beside a bare endpoint that commits one row of 1 KB.

The steps bring a scan that sees nothing, so that the map has nothing to compute: what remains is
HTTP, validation, order, the log and the commit. Both servers run in turn, several rounds, in one
run; the ratios are what counts. Run it as `python -m benchmarks.durable_step`.
"""

from __future__ import annotations

import os
import socket
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import orjson

from benchmarks.load import HOST, Load, exchange, request_bytes, run

ROUNDS = 5
COUNT = {1: 1_500, 16: 4_000}
SESSIONS = 16


@contextmanager
def server(code: str, environment: dict[str, str]) -> Iterator[int]:
    """Run a server in a process of its own, and give its port."""
    with socket.socket() as free:
        free.bind((HOST, 0))
        port: int = free.getsockname()[1]
    command = [sys.executable, "-c", code.format(port=port)]
    with subprocess.Popen(command, env={**os.environ, **environment}) as process:  # noqa: S603
        for _ in range(200):
            with socket.socket() as probe:
                if probe.connect_ex((HOST, port)) == 0:
                    break
            time.sleep(0.05)
        yield port
        process.terminate()


BARE = """
import gc, uvicorn
from benchmarks.bare import create_app
app = create_app(); gc.collect(); gc.freeze()
uvicorn.run(app, port={port}, access_log=False, log_level="warning")
"""

SEMTOPO = """
from service.app import serve
from service.settings import Settings
serve(Settings(port={port}, database="sqlite:///" + __import__("os").environ["STEP_DATABASE"]))
"""


def make_sessions(port: int) -> list[str]:
    """Begin sessions without a world, and return their ids."""

    async def make() -> list[str]:
        reader, writer = await asyncio.open_connection(HOST, port)
        ids = []
        for _ in range(SESSIONS):
            _, body = await exchange(reader, writer, request_bytes("POST", "/sessions", b"{}"))
            ids.append(orjson.loads(body)["id"])
        return ids

    import asyncio  # noqa: PLC0415

    return asyncio.run(make())


def main() -> None:
    """Measure in turn, and print the table."""
    beams = [[["unlabelled", 2.0]]] * 40
    scan = {"angle_min": 0.0, "angle_increment": 0.1, "range_max": 2.0, "beams": beams,
            "kinds": {"unlabelled": "unknown"}}  # fmt: skip
    step = orjson.dumps({"pose": {"x": 1.0, "y": 6.0, "theta": 0.0}, "scan": scan})
    row = orjson.dumps({"pose": {"x": 1.0, "y": 6.0}, "text": "x" * 960})
    found: dict[tuple[str, int], list[Load]] = {}
    with tempfile.TemporaryDirectory() as folder:
        files = {"BARE_DATABASE": f"{folder}/bare.db", "STEP_DATABASE": f"{folder}/step.db"}
        with server(BARE, files) as bare, server(SEMTOPO, files) as semtopo:
            ids = make_sessions(semtopo)
            posts = [request_bytes("POST", f"/sessions/{one}/step", step) for one in ids]
            post = request_bytes("POST", "/rows", row)
            for _ in range(ROUNDS + 1):
                for clients, count in COUNT.items():
                    one = run(bare, lambda _: post, clients=clients, count=count)
                    two = run(semtopo, lambda n: posts[n % SESSIONS], clients=clients, count=count)
                    found.setdefault(("bare", clients), []).append(one)
                    found.setdefault(("semtopo", clients), []).append(two)
        print(f"body {len(step)} B, step.db {Path(files['STEP_DATABASE']).stat().st_size} B")
    for (name, clients), loads in found.items():
        rounds = loads[1:]  # the first warms up
        p50, p99 = (statistics.median(one.percentile(s) for one in rounds) for s in (0.5, 0.99))
        rate = statistics.median(one.rate for one in rounds)
        print(f"{name:8} {clients:3} clients  p50 {p50:6.2f} ms  p99 {p99:6.2f} ms  {rate:6.0f}/s")


if __name__ == "__main__":
    main()
