"""Read the log of steps without the scans, which are nearly all of it: poses and answers."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from typing import Any

import orjson
from sqlalchemy import Connection, Row, func, or_, select

from semtopo.types import Point
from service.tables import api_keys, sessions, steps

POSE_CHARACTERS = 200
"""An input begins with its pose: three numbers of up to 25 characters, and their names."""

FETCHED_AT_ONCE = 256

_HEAD = func.substr(steps.c.input, 1, POSE_CHARACTERS).label("head")


@dataclass(frozen=True, slots=True)
class Taken:
    """A step that was taken: its pose and its answer, in JSON."""

    seq: int
    pose: str
    answer: str


@dataclass(frozen=True, slots=True)
class Progress:
    """How far a session has come, and whether the API key that it was made with still opens it."""

    seq: int
    is_open: bool


def find_progress(connection: Connection, numbers: Collection[int]) -> dict[int, Progress]:
    """Return how far sessions have come, by their numbers; those that are gone are left out."""
    query = (
        select(sessions.c.number, sessions.c.version, api_keys.c.revoked_at)
        .outerjoin(api_keys, api_keys.c.number == sessions.c.owner)
        .where(sessions.c.number.in_(numbers))
    )
    return {
        row.number: Progress(row.version, row.revoked_at is None)
        for row in connection.execute(query)
    }


def steps_after(connection: Connection, session: int, seq: int, limit: int) -> list[Taken]:
    """Return up to `limit` steps of a session after step `seq`, in order."""
    return list(_taken(connection, session, seq, limit))


def trail_after(
    connection: Connection, session: int, seq: int, limit: int
) -> tuple[list[list[float]], list[dict[str, Any]]]:
    """Return up to `limit` poses after step `seq`, as x, y, theta; and the steps with events."""
    poses, changes = [], []
    for one in _taken(connection, session, seq, limit):
        pose, answer = orjson.loads(one.pose), orjson.loads(one.answer)
        poses.append([pose["x"], pose["y"], pose["theta"]])
        if answer["events"]:
            changes.append({"seq": one.seq, "here": answer["here"], "events": answer["events"]})
    return poses, changes


def list_positions(connection: Connection, session: int, seq: int, stride: int) -> list[Point]:
    """Return where every `stride`-th step up to step `seq` was taken, and that step itself.

    In m, map frame, in order.
    """
    query = (
        select(_HEAD)
        .where(
            steps.c.session == session,
            steps.c.seq <= seq,
            or_(steps.c.seq % stride == 0, steps.c.seq == seq),
        )
        .order_by(steps.c.seq)
    )
    poses = [orjson.loads(_pose(head)) for head in connection.execute(query).scalars()]
    return [(pose["x"], pose["y"]) for pose in poses]


def _taken(connection: Connection, session: int, seq: int, limit: int) -> Iterator[Taken]:
    query = (
        select(steps.c.seq, _HEAD, steps.c.answer)
        .where(steps.c.session == session, steps.c.seq > seq)
        .order_by(steps.c.seq)
        .limit(limit)
        .execution_options(yield_per=FETCHED_AT_ONCE)
    )
    with connection.execute(query) as rows:
        yield from map(_read, rows)


def _read(row: Row[Any, Any, Any]) -> Taken:
    return Taken(row.seq, _pose(row.head), row.answer)


def _pose(head: str) -> str:
    """Return the pose in the head of an input, which is written by `model_dump_json`."""
    return head.removeprefix('{"pose":').partition("}")[0] + "}"
