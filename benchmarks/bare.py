"""The yardstick: a FastAPI endpoint that validates a body and commits one row of 1 KB."""

from __future__ import annotations

import os

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
    connection = dbapi2.connect(os.environ["BARE_DATABASE"], isolation_level=None)
    connection.execute("PRAGMA journal_mode = WAL")
    connection.execute("PRAGMA synchronous = FULL")
    connection.execute("CREATE TABLE IF NOT EXISTS rows (id INTEGER PRIMARY KEY, body TEXT)")
    app = FastAPI()

    @app.post("/rows", status_code=201)
    async def add_row(reading: Reading) -> Response:
        connection.execute("BEGIN IMMEDIATE")
        connection.execute("INSERT INTO rows (body) VALUES (?)", (reading.model_dump_json(),))
        connection.execute("COMMIT")
        return Response(orjson.dumps({"ok": True}), 201, media_type="application/json")

    return app
