"""Changes are committed in order and in groups, and each learns how it ended."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Callable, Iterator
from typing import Any

import pytest
from sqlalchemy import Connection, create_engine, insert, text
from sqlalchemy.exc import IntegrityError

from service.database import Database, open_database
from service.errors import BusyError, StorageError
from service.tables import zones
from service.writer import GROUP_MAX, GroupWriter, PoolWriter, Writer, open_writer

Change = Callable[[Connection], Any]


@pytest.fixture
def database(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Database]:
    """Give a database with a table of numbers."""
    opened = open_database(f"sqlite:///{tmp_path_factory.mktemp('writer') / 'semtopo.db'}")
    with opened.writer.begin() as connection:
        connection.execute(text("CREATE TABLE numbers (number INTEGER PRIMARY KEY)"))
    yield opened
    opened.close()


def add(number: int) -> Change:
    def change(connection: Connection) -> int:
        connection.execute(text("INSERT INTO numbers VALUES (:number)"), {"number": number})
        return 10 * number

    return change


def numbers(database: Database) -> list[int]:
    with database.reader.begin() as connection:
        return list(connection.scalars(text("SELECT number FROM numbers ORDER BY rowid")))


class Gate:
    """A change that holds the writer up until it is opened."""

    def __init__(self) -> None:
        self.reached = threading.Event()
        self.opened = threading.Event()

    def __call__(self, _connection: Connection) -> str:
        self.reached.set()
        assert self.opened.wait(10)
        return "through"


async def behind(writer: Writer, changes: list[Change]) -> list[Any]:
    """Hand changes in while the writer is held up, so that they gather; return how they ended."""
    gate = Gate()
    held = asyncio.create_task(writer.commit(gate))
    await asyncio.to_thread(gate.reached.wait)
    waiting = [asyncio.create_task(writer.commit(change)) for change in changes]
    await asyncio.sleep(0)
    gate.opened.set()
    assert await held == "through"
    return await asyncio.gather(*waiting, return_exceptions=True)


@pytest.fixture
def groups() -> list[int]:
    """Give the sizes of the transactions that the writer commits."""
    return []


@pytest.fixture
def writer(database: Database, groups: list[int]) -> Iterator[GroupWriter]:
    def committed(changes: int, seconds: float) -> None:
        assert seconds > 0
        groups.append(changes)

    opened = open_writer(database, 100, committed)
    assert isinstance(opened, GroupWriter)
    yield opened
    opened.close()


def test_a_change_is_committed_when_it_answers(database: Database, writer: GroupWriter) -> None:
    assert asyncio.run(writer.commit(add(1))) == 10
    assert numbers(database) == [1]


def test_what_has_gathered_is_committed_at_once(
    database: Database, writer: GroupWriter, groups: list[int]
) -> None:
    results = asyncio.run(behind(writer, [add(number) for number in range(20)]))
    assert results == [10 * number for number in range(20)]
    assert numbers(database) == list(range(20))
    writer.close()  # it tells of a group after it has answered
    assert groups == [1, 20]  # the one that held the others up, and the others
    assert writer.waiting == 0


def test_a_group_has_a_greatest_size(
    database: Database, writer: GroupWriter, groups: list[int]
) -> None:
    asyncio.run(behind(writer, [add(number) for number in range(GROUP_MAX + 1)]))
    writer.close()
    assert groups == [1, GROUP_MAX, 1]
    assert len(numbers(database)) == GROUP_MAX + 1


def fail(_connection: Connection) -> None:
    raise ZeroDivisionError


def add_by_driver(number: int) -> Change:
    """Add a number as the statements of a step do: past SQLAlchemy, which wraps no error then."""

    def change(connection: Connection) -> None:
        driver = connection.connection.driver_connection
        assert driver is not None
        driver.execute("INSERT INTO numbers VALUES (?)", (number,))

    return change


@pytest.mark.parametrize(
    ("bad", "outcome"),
    [
        pytest.param(fail, ZeroDivisionError, id="broken"),
        pytest.param(add(1), StorageError, id="refused by the database"),
        pytest.param(add_by_driver(1), StorageError, id="refused by the database, on the driver"),
    ],
)
def test_a_bad_change_does_not_fail_the_others(
    database: Database, writer: GroupWriter, bad: Change, outcome: type[Exception]
) -> None:
    asyncio.run(writer.commit(add(0)))
    results = asyncio.run(behind(writer, [add(1), bad, add(2), add(3)]))
    assert [results[0], *results[2:]] == [10, 20, 30]
    assert isinstance(results[1], outcome)
    assert numbers(database) == [0, 1, 2, 3]
    assert asyncio.run(writer.commit(add(4))) == 40


def test_a_storage_error_names_its_cause(writer: GroupWriter) -> None:
    asyncio.run(writer.commit(add(1)))
    with pytest.raises(StorageError) as caught:
        asyncio.run(writer.commit(add(1)))
    assert isinstance(caught.value.__cause__, IntegrityError)
    assert "number" not in str(caught.value)


def test_when_the_commit_fails_nobody_is_told_that_it_went_well(
    database: Database, writer: GroupWriter
) -> None:
    def postpone(connection: Connection) -> None:
        """Break a rule that is checked only at the commit."""
        connection.execute(text("PRAGMA defer_foreign_keys = ON"))
        zone = {"zone_id": "z", "position": 0, "label": "z", "since": 1, "seq": 1}
        connection.execute(insert(zones).values(session=999, region=b"", border=b"", **zone))

    results = asyncio.run(behind(writer, [add(1), postpone, add(2)]))
    assert all(isinstance(result, StorageError) for result in results)
    assert numbers(database) == []
    assert asyncio.run(writer.commit(add(3))) == 30


def test_a_full_queue_refuses(database: Database) -> None:
    async def crowd(writer: Writer) -> None:
        gate = Gate()
        held = asyncio.create_task(writer.commit(gate))
        await asyncio.to_thread(gate.reached.wait)
        waiting = [asyncio.create_task(writer.commit(add(number))) for number in range(3)]
        await asyncio.sleep(0)
        with pytest.raises(BusyError):
            await writer.commit(add(9))
        gate.opened.set()
        await asyncio.gather(held, *waiting)
        assert await writer.commit(add(4)) == 40

    writer = open_writer(database, queue_max=3)
    asyncio.run(crowd(writer))
    writer.close()
    assert numbers(database) == [0, 1, 2, 4]


def test_closing_finishes_what_was_handed_in(database: Database) -> None:
    async def hand_in(writer: Writer) -> list[Any]:
        gate = Gate()
        held = asyncio.create_task(writer.commit(gate))
        await asyncio.to_thread(gate.reached.wait)
        waiting = [asyncio.create_task(writer.commit(add(number))) for number in range(90)]
        await asyncio.sleep(0)
        closing = asyncio.create_task(asyncio.to_thread(writer.close))
        gate.opened.set()
        await closing
        await held
        return await asyncio.gather(*waiting)

    assert len(asyncio.run(hand_in(open_writer(database, queue_max=100)))) == 90
    assert numbers(database) == list(range(90))


def test_who_hangs_up_does_not_take_the_change_along(
    database: Database, writer: GroupWriter
) -> None:
    async def hang_up() -> None:
        gate = Gate()
        held = asyncio.create_task(writer.commit(gate))
        await asyncio.to_thread(gate.reached.wait)
        left = asyncio.create_task(writer.commit(add(1)))
        await asyncio.sleep(0)
        left.cancel()
        gate.opened.set()
        await held
        assert await writer.commit(add(2)) == 20

    asyncio.run(hang_up())
    assert numbers(database) == [1, 2]


def test_many_threads_where_the_database_locks_rows(database: Database) -> None:
    """The writer for PostgreSQL, here on SQLite: alike, but for the groups."""
    engine = create_engine(
        database.writer.url, module=database.writer.dialect.dbapi, connect_args={"timeout": 10}
    )
    writer = PoolWriter(engine, queue_max=10)

    async def crowd() -> list[Any]:
        return await asyncio.gather(
            *(writer.commit(change) for change in [add(1), fail, add(1), add(2)]),
            return_exceptions=True,
        )

    async def overfill() -> list[Any]:
        changes = [writer.commit(add(number)) for number in range(10, 25)]
        return await asyncio.gather(*changes, return_exceptions=True)

    results = asyncio.run(crowd())
    assert [type(result) for result in results[1::2]] == [ZeroDivisionError, int]
    assert {type(result) for result in results[0::2]} == {int, StorageError}
    assert sum(isinstance(result, BusyError) for result in asyncio.run(overfill())) == 5
    assert asyncio.run(writer.commit(add(5))) == 50
    writer.close()
    engine.dispose()
    assert sorted(numbers(database)) == [1, 2, 5, *range(10, 20)]
