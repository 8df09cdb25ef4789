"""Read back how a session was: what the robot saw, and what was noted."""

from __future__ import annotations

import orjson
from sqlalchemy import Connection

from semtopo import Pose, PoseDocument, Scan, ScanDocument
from service import store
from service.clock import seconds
from service.hot import HotSession
from service.notes import Notes, epoch
from service.stopwatch import Stopwatch


def notes_at(connection: Connection, hot: HotSession, seq: int) -> tuple[Notes, float]:
    """Return the notes as of step `seq`, which has been followed by another, and until when."""
    notes = Notes().after(store.list_changes(connection, hot.row.number, up_to=seq))
    following = store.find_time(connection, hot.row.number, seq + 1)
    return notes, seconds() if following is None else epoch(following)


def scan_at(connection: Connection, hot: HotSession, seq: int) -> tuple[Pose, Scan] | None:
    """Return where the robot was at step `seq` and what it saw; `None` before the first step."""
    logged = store.find_step(connection, hot.row.number, seq)
    return None if logged is None else look_again(hot, logged)


def look_again(hot: HotSession, logged: store.LoggedStep) -> tuple[Pose, Scan]:
    """Return where the robot was at a step, and what it saw there."""
    given = orjson.loads(logged.input)
    pose = PoseDocument.model_validate(given["pose"]).value()
    scan = given.get("scan")
    seen = None if scan is None else ScanDocument.model_validate(scan).value()
    return pose, hot.look(pose, seen, Stopwatch())
