"""The yardstick: a FastAPI endpoint that validates a body and commits one row of 1 KB, no more.

On a thread, as a server should, so that a slow disk stops nobody else; or right on the event loop,
which is as fast as it gets while the disk is fast, and stops the whole server whenever it is not.
"""

from __future__ import annotations

import asyncio
import os
from concurrent.futures import ThreadPoolExecutor

import orjson
from fastapi import FastAPI, Response
from pydantic import BaseModel
from pysqlite3 import dbapi2


class Reading(BaseModel):
    """A body of about 1 KB."""

    pose: dict[str, float]
    text: str


def create_app() -> FastAPI:
    """Return the application; its file is named by BARE_DATABASE."""
    connection = dbapi2.connect(
        os.environ["BARE_DATABASE"], isolation_level=None, check_same_thread=False
    )
    connection.execute("PRAGMA journal_mode = WAL")
    connection.execute("PRAGMA synchronous = FULL")
    connection.execute("CREATE TABLE IF NOT EXISTS rows (id INTEGER PRIMARY KEY, body TEXT)")
    writer = ThreadPoolExecutor(1)
    app = FastAPI()

    def commit(reading: Reading) -> None:
        connection.execute("BEGIN IMMEDIATE")
        connection.execute("INSERT INTO rows (body) VALUES (?)", (reading.model_dump_json(),))
        connection.execute("COMMIT")

    @app.post("/thread", status_code=201)
    async def add_row(reading: Reading) -> Response:
        await asyncio.get_running_loop().run_in_executor(writer, commit, reading)
        return Response(orjson.dumps({"ok": True}), 201, media_type="application/json")

    @app.post("/loop", status_code=201)
    async def add_row_at_once(reading: Reading) -> Response:
        commit(reading)
        return Response(orjson.dumps({"ok": True}), 201, media_type="application/json")

    return app
