"""Read the log of steps without the scans, which are nearly all of it: poses and answers."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

import orjson
from sqlalchemy import Connection, Row, func, or_, select

from semtopo.types import Point
from service.store.changes import Change, list_changes
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


class Moment(NamedTuple):
    """A moment in the history of a session: after step `seq`, and after that change; 0 for none.

    Changes are numbered through, and each is made after the step that was the last then.
    """

    seq: int
    revision: int = 0


@dataclass(frozen=True, slots=True)
class Progress:
    """How far a session has come, and whether the API key that it was made with still opens it."""

    moment: Moment
    is_open: bool


def find_progress(connection: Connection, numbers: Collection[int]) -> dict[int, Progress]:
    """Return how far sessions have come, by their numbers; those that are gone are left out."""
    query = (
        select(sessions.c.number, sessions.c.version, sessions.c.revision, api_keys.c.revoked_at)
        .outerjoin(api_keys, api_keys.c.number == sessions.c.owner)
        .where(sessions.c.number.in_(numbers))
    )
    return {
        row.number: Progress(Moment(row.version, row.revision), row.revoked_at is None)
        for row in connection.execute(query)
    }


def history_after(
    connection: Connection, session: int, moment: Moment, limit: int
) -> list[Taken | Change]:
    """Return what came after a moment, in order: up to `limit` steps, and changes among them.

    A change is told only after the step that it was made after, which may be read a moment before.
    """
    taken = list(_taken(connection, session, moment.seq, limit))
    last = taken[-1].seq if taken else moment.seq
    made = list_changes(connection, session, after=moment.revision, up_to=last)
    after = [one for one in made if Moment(one.seq, one.number) > moment]
    return sorted([*taken, *after], key=moment_of)


def moment_of(one: Taken | Change) -> Moment:
    """Return the moment of a step or a change."""
    return Moment(one.seq, 0 if isinstance(one, Taken) else one.number)


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
