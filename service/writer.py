"""Commit changes in the order in which they were handed in, several in one transaction.

SQLite has one write lock, and waiting for it is unfair and slow; so all changes go through one
thread, which takes what has gathered while it was busy and commits it at once (group commit).
PostgreSQL locks rows, so there each change has a transaction of its own, on several threads.
"""

from __future__ import annotations

import asyncio
import queue
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager, suppress
from time import perf_counter
from typing import Any, Protocol, TypeVar

from sqlalchemy import Connection, Engine

from service.database import Database
from service.errors import BusyError
from service.transactions import (
    Change,
    Committed,
    Outcome,
    database_errors,
    ignore,
    run_alone,
    storage_failure,
)

Result = TypeVar("Result")

_Item = tuple[Change, asyncio.Future[Any]]

GROUP_MAX = 64
"""Changes in one transaction; more would make the first of them wait too long."""

WRITERS = 8
"""Threads that write to PostgreSQL; each holds one connection while it works."""


class Writer(Protocol):
    """Something that commits changes."""

    @property
    def waiting(self) -> int:
        """How many changes wait to be committed."""
        ...

    async def commit(self, change: Callable[[Connection], Result]) -> Result:
        """Run a change in a transaction, commit it, and return its result.

        Raises
        ------
        BusyError
            Too many changes are waiting; this one was not taken.
        StorageError
            The database failed. Most likely the change was not made; only asking can tell.
        """
        ...

    def close(self) -> None:
        """Finish what was handed in, and stop."""
        ...


def open_writer(database: Database, queue_max: int, committed: Committed = ignore) -> Writer:
    """Return the writer that suits a database; it tells of every transaction that it commits."""
    if database.single_writer:
        return GroupWriter(database.writer, queue_max, committed)
    return PoolWriter(database.writer, queue_max, committed)


class GroupWriter:
    """One thread and one connection, which commit in groups."""

    def __init__(self, engine: Engine, queue_max: int, committed: Committed = ignore) -> None:
        """Start the thread."""
        self._committed = committed
        self._connection = engine.connect()  # kept: to take it up anew would cost 0.1 ms
        self._driver: Any = self._connection.connection.driver_connection
        self._errors = database_errors(engine)
        self._waiting: queue.SimpleQueue[_Item | None] = queue.SimpleQueue()
        self._queue_max = queue_max
        self._thread = threading.Thread(target=self._work, name="writer")
        self._thread.start()

    @property
    def waiting(self) -> int:
        """How many changes wait to be committed."""
        return self._waiting.qsize()

    async def commit(self, change: Callable[[Connection], Result]) -> Result:
        """Run a change together with others that are waiting; see `Writer`."""
        if self.waiting >= self._queue_max:
            raise BusyError("too many steps are waiting to be stored")
        future: asyncio.Future[Result] = asyncio.get_running_loop().create_future()
        self._waiting.put((change, future))
        return await future

    def close(self) -> None:
        """Finish what was handed in, and stop the thread."""
        self._waiting.put(None)
        self._thread.join()
        self._connection.close()

    def _work(self) -> None:
        """Take group after group, until the mark that ends the work."""
        while True:
            group = [self._waiting.get()]
            while len(group) < GROUP_MAX and not self._waiting.empty():
                group.append(self._waiting.get())
            work = [item for item in group if item is not None]
            if work:
                begun = perf_counter()
                outcomes = self._outcomes([change for change, _ in work])
                seconds = perf_counter() - begun
                _tell([future for _, future in work], outcomes)
                self._count(outcomes, seconds)
            if len(work) < len(group):
                return

    def _outcomes(self, changes: list[Change]) -> list[Outcome]:
        """Commit changes together; if one of them fails, each alone."""
        try:
            with self._begin() as connection:
                results = _run_all(connection, changes)
        except _SpoiltError:
            return [run_alone(self._begin, self._errors, change) for change in changes]
        except self._errors as error:
            return [(None, storage_failure(error))] * len(changes)
        except Exception as error:  # noqa: BLE001 -- the thread must live; the callers are told
            return [(None, error)] * len(changes)
        return [(result, None) for result in results]

    def _count(self, outcomes: list[Outcome], seconds: float) -> None:
        """Tell of what was committed."""
        changes = sum(error is None for _, error in outcomes)
        if changes:
            self._committed(changes, seconds)

    @contextmanager
    def _begin(self) -> Iterator[Connection]:
        """Give the connection in a transaction, and leave it without one.

        It begins on the driver; SQLAlchemy joins in when it is first used.
        """
        try:
            self._driver.execute("BEGIN IMMEDIATE")
            yield self._connection
            if self._connection.in_transaction():
                self._connection.commit()
            else:
                self._driver.commit()
        except BaseException:
            self._connection.rollback()
            self._driver.rollback()  # a commit that failed may have left it open
            raise


class PoolWriter:
    """Several threads, and a transaction for each change."""

    def __init__(self, engine: Engine, queue_max: int, committed: Committed = ignore) -> None:
        """Make the threads."""
        self._begin = engine.begin
        self._committed = committed
        self._errors = database_errors(engine)
        self._pool = ThreadPoolExecutor(WRITERS, thread_name_prefix="writer")
        self._free = self._queue_max = queue_max

    @property
    def waiting(self) -> int:
        """How many changes wait to be committed."""
        return self._queue_max - self._free

    async def commit(self, change: Callable[[Connection], Result]) -> Result:
        """Run a change in a transaction of its own; see `Writer`."""
        if self._free <= 0:
            raise BusyError("too many steps are waiting to be stored")
        self._free -= 1
        try:
            result, error = await asyncio.get_running_loop().run_in_executor(
                self._pool, self._timed, change
            )
        finally:
            self._free += 1
        if error is not None:
            raise error
        made: Result = result
        return made

    def _timed(self, change: Change) -> Outcome:
        begun = perf_counter()
        outcome = run_alone(self._begin, self._errors, change)
        if outcome[1] is None:
            self._committed(1, perf_counter() - begun)
        return outcome

    def close(self) -> None:
        """Finish what was handed in, and stop the threads."""
        self._pool.shutdown()


class _SpoiltError(Exception):
    """One change of a group failed, so nothing of the group was made."""


def _run_all(connection: Connection, changes: list[Change]) -> list[Any]:
    try:
        return [change(connection) for change in changes]
    except Exception as error:
        raise _SpoiltError from error


def _tell(futures: list[asyncio.Future[Any]], outcomes: list[Outcome]) -> None:
    """Settle futures from another thread: the loop is woken once for all of them."""
    with suppress(RuntimeError):  # the loop is closed: nobody waits any more
        futures[0].get_loop().call_soon_threadsafe(_settle, futures, outcomes)


def _settle(futures: list[asyncio.Future[Any]], outcomes: list[Outcome]) -> None:
    for future, (result, error) in zip(futures, outcomes, strict=True):
        if future.cancelled():
            continue
        if error is None:
            future.set_result(result)
        else:
            future.set_exception(error)
