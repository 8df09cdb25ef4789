"""Begin each session once, however often it is asked for; and end those that nobody uses."""

from __future__ import annotations

from dataclasses import dataclass

from sqlalchemy import Connection, and_, delete, func, insert, select

from service.store.sessions import NewSession, add_session
from service.tables import creations, sessions, steps


@dataclass(frozen=True, slots=True)
class CreationKey:
    """The Idempotency-Key of a session that is to begin, and the SHA-256 of what was asked for."""

    key: str
    fingerprint: bytes


def begin_session(connection: Connection, new: NewSession, key: CreationKey) -> str | None:
    """Store a new session, and return its id; of the earlier one, if its key began one already.

    Return `None` if that was another one. An owner's keys are apart from those of others.
    """
    scope = 0 if new.owner is None else new.owner
    mine = and_(creations.c.scope == scope, creations.c.key == key.key)
    query = select(sessions.c.id, creations.c.fingerprint).join(creations).where(mine)
    earlier = connection.execute(query).one_or_none()
    if earlier is not None:
        found: str = earlier.id
        return found if earlier.fingerprint == key.fingerprint else None
    number = add_session(connection, new)
    values = {"scope": scope, "session": number, "key": key.key, "fingerprint": key.fingerprint}
    connection.execute(insert(creations).values(values))
    return new.id


def list_unused(connection: Connection, before: str, limit: int) -> list[str]:
    """Return the ids of up to `limit` sessions that began, and took no step, since `before`."""
    last = and_(steps.c.session == sessions.c.number, steps.c.seq == sessions.c.version)
    used_at = func.coalesce(steps.c.taken_at, sessions.c.created_at)
    query = select(sessions.c.id).outerjoin(steps, last)
    query = query.where(sessions.c.created_at < before, used_at < before)
    return list(connection.scalars(query.order_by(sessions.c.number).limit(limit)))


def delete_unused(connection: Connection, session_id: str, before: str) -> bool:
    """Delete a session unless it was used since `before`; say whether it was deleted."""
    later = select(steps.c.seq).where(
        steps.c.session == sessions.c.number, steps.c.taken_at >= before
    )
    unused = and_(sessions.c.created_at < before, ~later.exists())
    found = delete(sessions).where(sessions.c.id == session_id, unused)
    return connection.execute(found).rowcount > 0
