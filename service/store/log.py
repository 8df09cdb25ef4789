"""The log of steps: what came in and what was answered, to be read back and never changed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from sqlalchemy import Connection, Row, bindparam, insert, select

from service.statements import Statement, find, run
from service.tables import steps

PAGE_CHARACTERS = 2**22
"""Of input and answers in one page of the log; a step may bring a scan of 1 MiB."""

FETCHED_AT_ONCE = 16
"""Steps of the log."""

_ADD_STEP = Statement(insert(steps))


@dataclass(frozen=True, slots=True)
class LoggedStep:
    """A step as it is stored: what came in, and what was answered, in JSON."""

    seq: int
    taken_at: str
    key: str | None
    fingerprint: bytes
    input: str
    answer: str


_FIND_BY_KEY = Statement(
    select(*(steps.c[name] for name in LoggedStep.__slots__)).where(
        steps.c.session == bindparam("session"), steps.c.key == bindparam("key")
    )
)


def add_step(connection: Connection, session: int, logged: LoggedStep) -> None:
    """Append a step to the log."""
    values = {name: getattr(logged, name) for name in LoggedStep.__slots__}
    run(connection, _ADD_STEP, {"session": session, **values})


def find_step(connection: Connection, session: int, seq: int) -> LoggedStep | None:
    """Return one step of a session, or `None` if it was not taken yet."""
    query = select(steps).where(steps.c.session == session, steps.c.seq == seq)
    row = connection.execute(query).one_or_none()
    return None if row is None else _logged(row)


def find_step_by_key(connection: Connection, session: int, key: str) -> LoggedStep | None:
    """Return the step of a session that was sent with an Idempotency-Key, if any."""
    row = find(connection, _FIND_BY_KEY, {"session": session, "key": key})
    return None if row is None else LoggedStep(*row)


def list_steps(
    connection: Connection, session: int, after: int, limit: int
) -> Iterator[LoggedStep]:  # fmt: skip
    """Yield up to `limit` steps of a session whose seq is above `after`, in order.

    They are fetched a few at a time, since together they may be very large.
    """
    query = select(steps).where(steps.c.session == session, steps.c.seq > after)
    few = query.order_by(steps.c.seq).limit(limit).execution_options(yield_per=FETCHED_AT_ONCE)
    with connection.execute(few) as rows:
        yield from map(_logged, rows)


def page_of_steps(
    connection: Connection, session: int, after: int, limit: int
) -> tuple[list[LoggedStep], bool]:
    """Return up to `limit` steps after step `after`, in order, and whether more follow.

    A page is shorter where it would else have more than `PAGE_CHARACTERS`, but never empty.
    """
    page: list[LoggedStep] = []
    size = 0
    for logged in list_steps(connection, session, after, limit + 1):
        size += len(logged.input) + len(logged.answer)
        if page and (len(page) == limit or size > PAGE_CHARACTERS):
            return page, True
        page.append(logged)
    return page, False


def _logged(row: Row[Any]) -> LoggedStep:
    return LoggedStep(**{name: getattr(row, name) for name in LoggedStep.__slots__})
