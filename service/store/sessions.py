"""Rows of sessions: who they are, and how many steps each has taken."""

from __future__ import annotations

from dataclasses import dataclass, fields

from sqlalchemy import Connection, bindparam, delete, insert, select, update
from sqlalchemy.exc import SQLAlchemyError

from service.statements import Statement, find, run
from service.tables import sessions, worlds

CHECKPOINT_EVERY = 32
"""Steps between checkpoints: replaying 31 steps takes some 25 ms in the paper's world. With twice
as many, earlier maps take two thirds on disk."""

_ADVANCE = Statement(
    update(sessions)
    .where(
        sessions.c.number == bindparam("at_number"), sessions.c.version == bindparam("at_version")
    )
    .values(version=bindparam("version"))
)

_FIND_VERSION = select(sessions.c.number, sessions.c.version, sessions.c.revision).where(
    sessions.c.id == bindparam("session_id")
)

_GLANCE = Statement(_FIND_VERSION)


@dataclass(frozen=True, slots=True, kw_only=True)
class SessionHead:
    """What a listing tells of a session; `version` is the seq of its last step."""

    number: int
    id: str
    name: str
    created_at: str
    version: int


@dataclass(frozen=True, slots=True, kw_only=True)
class SessionRow(SessionHead):
    """A session as it is stored; world, sensor and mapping are JSON.

    A real robot's has no world. `revision` is the number of changes that are no steps, and
    `checkpoint_every` the number of steps between checkpoints of its map.
    """

    owner: int | None
    world: str | None
    sensor: str
    mapping: str
    engine: str
    revision: int
    checkpoint_every: int


@dataclass(frozen=True, slots=True)
class NewSession:
    """A session to be stored."""

    id: str
    name: str
    created_at: str
    world: str | None
    sensor: str
    mapping: str
    engine: str
    owner: int | None = None


def add_session(connection: Connection, new: NewSession) -> int:
    """Store a new session, with an empty map; return its number."""
    values = {name: getattr(new, name) for name in NewSession.__slots__ if name != "world"}
    made = connection.execute(
        insert(sessions).values(version=0, checkpoint_every=CHECKPOINT_EVERY, **values)
    )
    (number,) = made.inserted_primary_key or (0,)
    if new.world is not None:
        connection.execute(insert(worlds).values(session=number, world=new.world))
    return int(number)


def find_session(connection: Connection, session_id: str) -> SessionRow | None:
    """Return a session, or `None` if there is none of that id."""
    query = select(sessions, worlds.c.world).outerjoin(worlds).where(sessions.c.id == session_id)
    row = connection.execute(query).mappings().one_or_none()
    return None if row is None else SessionRow(**row)


def list_sessions(
    connection: Connection, owner: int | None, after: int, limit: int, *, newest: bool = False
) -> list[SessionHead]:
    """Return up to `limit` sessions, oldest first, whose number is above `after`.

    Or the newest first, and below `after`, where that is not 0. With an owner, only the sessions
    made with that API key.
    """
    columns = [sessions.c[field.name] for field in fields(SessionHead)]
    number = sessions.c.number
    query = select(*columns).order_by(number.desc() if newest else number)
    if not newest or after:
        query = query.where(number < after if newest else number > after)
    if owner is not None:
        query = query.where(sessions.c.owner == owner)
    return [SessionHead(**row) for row in connection.execute(query.limit(limit)).mappings()]


def delete_session(connection: Connection, session_id: str) -> bool:
    """Delete a session with all that belongs to it; say whether there was one."""
    return connection.execute(delete(sessions).where(sessions.c.id == session_id)).rowcount > 0


def find_version(connection: Connection, session_id: str) -> tuple[int, int, int] | None:
    """Return the number of a session, the seq of its last step and its number of changes.

    `None` if there is no such session.
    """
    row = connection.execute(_FIND_VERSION, {"session_id": session_id}).one_or_none()
    return None if row is None else (row.number, row.version, row.revision)


def is_at(glance: Connection, session_id: str, version: tuple[int, int, int]) -> bool:
    """Say whether a session is at a version as `find_version` tells it, at once.

    False too where the database cannot tell: `find_version` waits, or says what is wrong.
    """
    try:
        return find(glance, _GLANCE, {"session_id": session_id}) == version
    except (glance.dialect.loaded_dbapi.Error, SQLAlchemyError):
        return False


def advance(connection: Connection, session: int, base: int) -> bool:
    """Move a session from version `base` to the next; say whether it was at `base`.

    Where several processes write, the first one wins, and locks the session until it commits.
    """
    values = {"at_number": session, "at_version": base, "version": base + 1}
    return run(connection, _ADVANCE, values) == 1
