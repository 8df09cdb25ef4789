"""Reads over HTTP: zones and graph beside a bare endpoint that returns the same bytes."""

from __future__ import annotations

import asyncio
import tempfile
from collections.abc import Iterator
from http.client import HTTPConnection
from pathlib import Path

import orjson

from benchmarks.durable_step import SEMTOPO, server
from benchmarks.load import HOST, Load, exchange, request_bytes, run
from benchmarks.table import Row, Table
from benchmarks.worlds import PITCH, ROOM, floor

READS = 2_000
ROUNDS = 3
ROOMS = 100

BARE = """
import os, uvicorn
from fastapi import FastAPI, Response
app, body = FastAPI(), open(os.environ["BODY_FILE"], "rb").read()

@app.get("/body")
async def read() -> Response:
    return Response(body, media_type="application/json")

uvicorn.run(app, port={port}, access_log=False, log_level="warning")
"""


async def _ask(port: int, method: str, target: str, body: bytes = b"") -> bytes:
    reader, writer = await asyncio.open_connection(HOST, port)
    _, answer = await exchange(reader, writer, request_bytes(method, target, body))
    writer.close()
    return answer


def ask(port: int, method: str, target: str, body: bytes = b"") -> bytes:
    """Return the body of one answer."""
    return asyncio.run(_ask(port, method, target, body))


def new_session(port: int, document: bytes) -> str:
    """Begin a session, and return its path."""
    return f"/sessions/{orjson.loads(ask(port, 'POST', '/sessions', document))['id']}"


def hundred_zones(port: int) -> str:
    """Return the path of a session whose map has 100 zones."""
    zones = [
        {"label": it.label, "kind": it.kind.name.lower(), "low": it.low, "high": it.high}
        for it in floor(2 * ROOMS).zones
    ]
    session = new_session(port, orjson.dumps({"world": {"zones": zones}}))
    across = max(2, round(ROOMS**0.5))
    for number in range(ROOMS):
        row, column = divmod(number, across)
        pose = {"x": column * PITCH + ROOM / 2, "y": row * PITCH + ROOM / 2}
        ask(port, "POST", f"{session}/step", orjson.dumps({"pose": pose}))
    return session


def reads(port: int, request: bytes, expected: int = 200) -> Load:
    """Return how long reads take, one after the other."""
    return run(port, lambda _: request, clients=1, count=READS, expected=expected)


def entity_tag(port: int, target: str) -> str:
    """Return the entity tag of what is read."""
    connection = HTTPConnection(HOST, port)
    connection.request("GET", target)
    tag = connection.getresponse().headers["ETag"]
    connection.close()
    return str(tag)


def read_rows(port: int, session: str, folder: Path) -> Iterator[Row]:
    """Yield what reading zones and graph costs, beside a bare endpoint with the same bytes."""
    for name in ("zones", "graph"):
        target = f"{session}/{name}"
        body, tag = ask(port, "GET", target), entity_tag(port, target)
        file = folder / name
        file.write_bytes(body)
        with server(BARE, {"BODY_FILE": str(file)}) as bare_port:
            ask(bare_port, "GET", "/body")
            ours, bare, known = [], [], []
            for _ in range(ROUNDS):
                ours.append(reads(port, request_bytes("GET", target)))
                bare.append(reads(bare_port, request_bytes("GET", "/body")))
                known.append(reads(port, request_bytes("GET", target, If_None_Match=tag), 304))
        mine, theirs, short = (
            min(it.percentile(0.5) for it in loads) for loads in (ours, bare, known)
        )
        yield {
            "read": f"{name} of {ROOMS} zones", "bytes": f"{len(body):,}",
            "p50, ms": f"{mine:.2f}", "bare p50, ms": f"{theirs:.2f}",
            "ratio": f"{mine / theirs:.2f}", "304 p50, ms": f"{short:.2f}",
            "304 ratio": f"{short / theirs:.2f}",
        }  # fmt: skip


def tables() -> Iterator[Table]:
    """Yield what reads cost over HTTP."""
    with tempfile.TemporaryDirectory() as folder:
        environment = {"STEP_DATABASE": str(Path(folder) / "reads.db")}
        with server(SEMTOPO, environment) as port:
            session = hundred_zones(port)
            yield "Reads over HTTP", list(read_rows(port, session, Path(folder)))
