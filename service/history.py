"""Read back earlier maps: from the last checkpoint, the log is replayed."""

from __future__ import annotations

from dataclasses import replace

import orjson
from sqlalchemy import Connection

from semtopo import LabelledRuns, MapState, Pose, PoseDocument, Scan, ScanDocument
from service import store
from service.clock import seconds
from service.hot import HotSession
from service.notes import Notes, epoch
from service.stopwatch import Stopwatch


def state_at(connection: Connection, hot: HotSession, seq: int) -> MapState:
    """Return the map of a session as of step `seq`, which it has taken; 0 is the empty map."""
    state = store.load_checkpoint(connection, hot.row.number, seq)
    for logged in store.list_steps(connection, hot.row.number, state.seq, seq - state.seq):
        state = _retaken(replace(hot, state=state), logged)
    return state


def notes_at(connection: Connection, hot: HotSession, seq: int) -> tuple[Notes, float]:
    """Return the notes as of step `seq`, which has been followed by another, and until when."""
    notes = Notes().after(store.list_changes(connection, hot.row.number, up_to=seq))
    following = store.find_time(connection, hot.row.number, seq + 1)
    return notes, seconds() if following is None else epoch(following)


def scan_at(connection: Connection, hot: HotSession, seq: int) -> tuple[Pose, Scan] | None:
    """Return where the robot was at step `seq` and what it saw; `None` before the first step."""
    logged = store.find_step(connection, hot.row.number, seq)
    if logged is None:
        return None
    pose, seen = _given(logged)
    return pose, hot.look(pose, seen, Stopwatch())


def _retaken(hot: HotSession, logged: store.LoggedStep) -> MapState:
    return hot.take(*_given(logged), Stopwatch()).state


def _given(logged: store.LoggedStep) -> tuple[Pose, LabelledRuns | None]:
    """Return what came in with a step."""
    given = orjson.loads(logged.input)
    pose = PoseDocument.model_validate(given["pose"]).value()
    scan = given.get("scan")
    return pose, None if scan is None else ScanDocument.model_validate(scan).value()
