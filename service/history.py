"""Read back earlier maps: from the last checkpoint, the log is replayed."""

from __future__ import annotations

from dataclasses import replace

import orjson
from sqlalchemy import Connection

from semtopo import MapState, PoseDocument, ScanDocument
from service import store
from service.hot import HotSession
from service.stopwatch import Stopwatch


def state_at(connection: Connection, hot: HotSession, seq: int) -> MapState:
    """Return the map of a session as of step `seq`, which it has taken; 0 is the empty map."""
    state = store.load_checkpoint(connection, hot.row.number, seq)
    for logged in store.list_steps(connection, hot.row.number, state.seq, seq - state.seq):
        state = _retaken(replace(hot, state=state), logged)
    return state


def _retaken(hot: HotSession, logged: store.LoggedStep) -> MapState:
    given = orjson.loads(logged.input)
    pose = PoseDocument.model_validate(given["pose"]).value()
    scan = given.get("scan")
    seen = None if scan is None else ScanDocument.model_validate(scan).value()
    return hot.take(pose, seen, Stopwatch()).state
