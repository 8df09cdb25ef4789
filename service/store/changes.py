"""Rows of changes: what people noted about a map between its steps, in order."""

from __future__ import annotations

from dataclasses import dataclass

from sqlalchemy import Connection, insert, select, update

from service.tables import changes, sessions, steps


@dataclass(frozen=True, slots=True)
class Change:
    """A change as it is stored: made after step `seq`; `document` is JSON."""

    number: int
    seq: int
    made_at: str
    kind: str
    document: str


def add_change(connection: Connection, session: int, change: Change) -> bool:
    """Append a change, if the session is as it was when the change was worked out; say whether.

    It must be at step `change.seq`, and have `change.number - 1` changes.
    """
    as_it_was = (
        (sessions.c.number == session)
        & (sessions.c.version == change.seq)
        & (sessions.c.revision == change.number - 1)
    )
    moved = connection.execute(update(sessions).where(as_it_was).values(revision=change.number))
    if moved.rowcount != 1:
        return False
    values = {name: getattr(change, name) for name in Change.__slots__}
    connection.execute(insert(changes).values(session=session, **values))
    return True


def list_changes(
    connection: Connection, session: int, *, after: int = 0, up_to: int | None = None
) -> list[Change]:
    """Return the changes above number `after`, and made up to step `up_to`, in order."""
    columns = [changes.c[name] for name in Change.__slots__]
    query = select(*columns).where(changes.c.session == session, changes.c.number > after)
    if up_to is not None:
        query = query.where(changes.c.seq <= up_to)
    return [Change(*row) for row in connection.execute(query.order_by(changes.c.number))]


def find_time(connection: Connection, session: int, seq: int) -> str | None:
    """Return when a step was taken, or `None` if it was not."""
    query = select(steps.c.taken_at).where(steps.c.session == session, steps.c.seq == seq)
    return connection.execute(query).scalar_one_or_none()
