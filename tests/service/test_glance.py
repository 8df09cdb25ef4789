"""A session in memory is checked at a glance, and never believed when the database knows better."""

from __future__ import annotations

import asyncio
import sqlite3
from collections.abc import Callable, Iterator
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from sqlalchemy import Connection, event

from semtopo import MapState
from semtopo.documents import MappingDocument, SensorDocument
from service import database as module
from service import store
from service.database import Database, open_database
from service.errors import UnknownSessionError
from service.metrics import Metrics
from service.sessions import Sessions
from service.settings import Settings
from service.writer import open_writer
from tests.servers import Server
from tests.service.test_store import logged_as, new
from tests.service.twin import paper_steps, paper_world


@pytest.fixture
def database(tmp_path: Path) -> Iterator[Database]:
    """Give a database with a session `one` that has taken no step."""
    opened = open_database(f"sqlite:///{tmp_path / 'semtopo.db'}")
    if opened.glance is None:
        opened.close()
        pytest.skip("this SQLite does not get WAL")
    with opened.writer.begin() as connection:
        store.add_session(connection, session("one"))
    yield opened
    opened.close()


def session(name: str, world: str | None = None) -> store.NewSession:
    documents = (SensorDocument(), MappingDocument())
    sensor, mapping = (it.model_dump_json() for it in documents)
    return replace(new(name), world=world, sensor=sensor, mapping=mapping)


def glance_of(database: Database) -> Connection:
    assert database.glance is not None
    return database.glance


def take_step(database: Database, name: str) -> tuple[int, int, int]:
    """Take a step that changes nothing of the map, and return the version before it."""
    with database.writer.begin() as connection:
        found = store.find_version(connection, name)
        assert found is not None
        after = MapState(seq=found[1] + 1, position=(1.0, 2.0))
        store.add_step(connection, found[0], logged_as(after))
        assert store.advance(connection, found[0], found[1])
    return found


class Reading:
    """Sessions of a database, and how often they read in a transaction of their own."""

    def __init__(self, database: Database) -> None:
        self.count = 0
        metrics = Metrics()
        writer = open_writer(database, 10, metrics.time_commit)
        self.sessions = Sessions(database, writer, Settings(), metrics)
        self.close = writer.close
        event.listen(database.reader, "begin", self._note)

    def _note(self, _connection: Connection) -> None:
        self.count += 1

    def seq(self, name: str) -> int:
        return asyncio.run(self.sessions.find(name)).seq


@pytest.fixture
def reading(database: Database) -> Iterator[Reading]:
    """Give the sessions of the database."""
    made = Reading(database)
    yield made
    made.close()


def test_a_glance_tells_a_version_from_all_others(database: Database) -> None:
    glance = glance_of(database)
    old = take_step(database, "one")
    new_version = (old[0], old[1] + 1, old[2])
    assert store.is_at(glance, "one", new_version)
    for wrong in (old, (old[0] + 1, 1, 0), (old[0], 1, 1)):
        assert not store.is_at(glance, "one", wrong)
    assert not store.is_at(glance, "two", new_version)
    with database.writer.begin() as connection:
        store.delete_session(connection, "one")
    assert not store.is_at(glance, "one", new_version)


def test_a_glance_sees_each_commit_and_nothing_before_it(database: Database) -> None:
    glance = glance_of(database)
    for seq in range(50):
        before = take_step(database, "one")
        assert before[1] == seq
        assert not store.is_at(glance, "one", before)
        with database.writer.begin() as connection:
            assert store.advance(connection, before[0], seq + 1)
            assert store.is_at(glance, "one", (before[0], seq + 1, 0))
            connection.rollback()


def test_a_glance_behind_a_large_world(database: Database) -> None:
    """Its version lies behind its world, on another page of the file."""
    with database.writer.begin() as connection:
        store.add_session(connection, session("large", world="x" * 900_000))
    old = take_step(database, "large")
    assert not store.is_at(glance_of(database), "large", old)
    assert store.is_at(glance_of(database), "large", (old[0], 1, 0))


def test_a_glance_holds_nobody_up(database: Database) -> None:
    """A reader that stays in a transaction would keep the log from being taken over."""
    glance = glance_of(database)
    old = take_step(database, "one")
    assert store.is_at(glance, "one", (old[0], 1, 0))
    with database.writer.connect() as connection:
        below: Any = connection.connection.driver_connection  # in no transaction
        busy, frames, _ = below.execute("PRAGMA wal_checkpoint(TRUNCATE)").fetchone()
    assert (busy, frames) == (0, 0)
    assert store.is_at(glance, "one", (old[0], 1, 0))


def test_a_glance_takes_no_place_of_the_readers(database: Database) -> None:
    connections = [database.reader.connect() for _ in range(16)]
    assert store.is_at(glance_of(database), "one", (1, 0, 0))
    for connection in connections:
        connection.close()


@pytest.mark.parametrize("how", ["connection", "driver"])
def test_a_glance_at_what_is_closed_tells_nothing(database: Database, how: str) -> None:
    glance = glance_of(database)
    below = glance.connection.driver_connection
    assert below is not None
    (glance if how == "connection" else below).close()
    assert not store.is_at(glance, "one", (1, 0, 0))


def test_what_is_unchanged_needs_no_transaction(database: Database, reading: Reading) -> None:
    assert [reading.seq("one") for _ in range(20)] == [0] * 20
    assert reading.count == 1
    take_step(database, "one")
    assert [reading.seq("one") for _ in range(20)] == [1] * 20
    assert reading.count == 2


def test_what_is_deleted_is_not_found_though_it_is_in_memory(
    database: Database, reading: Reading
) -> None:
    assert reading.seq("one") == 0
    with database.writer.begin() as connection:
        store.delete_session(connection, "one")
        number = store.add_session(connection, session("other"))
    with pytest.raises(UnknownSessionError):
        reading.seq("one")
    with pytest.raises(UnknownSessionError):
        reading.seq("never")
    with database.writer.begin() as connection:
        again = store.add_session(connection, session("one"))
    assert asyncio.run(reading.sessions.find("one")).row.number == again > number


def test_without_a_glance_a_reader_looks(database: Database, reading: Reading) -> None:
    glance_of(database).close()
    assert [reading.seq("one") for _ in range(3)] == [0] * 3
    assert reading.count == 3
    take_step(database, "one")
    assert reading.seq("one") == 1


def test_a_rollback_journal_gets_no_glance(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """There a reader may have to wait for a writer."""
    monkeypatch.setattr(module, "_journal_mode", lambda _driver: "DELETE")
    opened = open_database(f"sqlite:///{tmp_path / 'semtopo.db'}")
    assert opened.glance is None
    opened.close()


@pytest.mark.databases("postgres")
def test_postgresql_gets_no_glance(new_database: Callable[[], str]) -> None:
    """There a reader waits for the wire."""
    opened = open_database(new_database())
    assert opened.glance is None
    opened.close()


def test_a_database_that_fails_is_a_problem_and_no_fault(server: Server) -> None:
    """The table of sessions is away for a while, and memory does not stand in for it."""
    path = server.create(world=paper_world())
    server.step(path, paper_steps()[0])
    read = [f"{path}/graph", f"{path}/zones", path]
    before = [server.get(it) for it in read]
    with closing(sqlite3.connect(server.database, isolation_level=None)) as connection:
        connection.execute("PRAGMA legacy_alter_table = ON")
        connection.execute("ALTER TABLE sessions RENAME TO away")
        try:
            answers = [server.client.get(it) for it in read]
        finally:
            connection.execute("ALTER TABLE away RENAME TO sessions")
    assert {it.status_code for it in answers} == {503}
    assert {it.json()["code"] for it in answers} == {"storage_unavailable"}
    assert [server.get(it) for it in read] == before
