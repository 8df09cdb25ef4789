"""Opening a database: durable, strict, up to date, also when several do so at once."""

from __future__ import annotations

import logging
import os
import re
import sqlite3
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace

import pytest
from alembic import command
from alembic.autogenerate import compare_metadata
from alembic.migration import MigrationContext
from sqlalchemy import Engine, insert, inspect, make_url, text
from sqlalchemy.exc import DBAPIError

from service import database as module
from service.database import Database, migration_config, open_database
from service.errors import InvalidDatabaseError, StorageError
from service.tables import metadata, sessions
from tests.service.twin import ROOT

OUR_SQLITE: tuple[int, ...] = (vars(module)["bundled_sqlite"] or sqlite3).sqlite_version_info


@pytest.fixture
def url(tmp_path_factory: pytest.TempPathFactory) -> str:
    """Give the URL of a file that is not there yet."""
    return f"sqlite:///{tmp_path_factory.mktemp('database') / 'semtopo.db'}"


@pytest.fixture
def database(url: str) -> Iterator[Database]:
    """Give an open database."""
    opened = open_database(url)
    yield opened
    opened.close()


SESSION = {
    "id": "a", "name": "", "created_at": "", "sensor": "", "mapping": "", "engine": "",
    "version": 0,
}  # fmt: skip


def pragmas(engine: Engine) -> Iterator[dict[str, object]]:
    """Yield the settings of three connections that are open at the same time."""
    names = ["journal_mode", "synchronous", "foreign_keys", "query_only", "busy_timeout"]
    connections = [engine.connect() for _ in range(3)]
    for connection in connections:
        yield {name: connection.scalar(text(f"PRAGMA {name}")) for name in names}
    for connection in connections:
        connection.close()


@pytest.mark.skipif(OUR_SQLITE < (3, 51, 3), reason="this SQLite does not get WAL")
def test_every_connection_is_durable_and_strict(database: Database) -> None:
    durable = {
        "journal_mode": "wal", "synchronous": 2, "foreign_keys": 1, "busy_timeout": 5000,
    }  # fmt: skip
    assert all(found == durable | {"query_only": 1} for found in pragmas(database.reader))
    with database.writer.connect() as connection:
        found = {name: connection.scalar(text(f"PRAGMA {name}")) for name in durable}
        assert found == durable


def test_readers_cannot_write(database: Database) -> None:
    with database.reader.connect() as connection, pytest.raises(DBAPIError, match="readonly"):
        connection.execute(text("DELETE FROM sessions"))


def test_a_reader_sees_one_state(database: Database) -> None:
    count = text("SELECT count(*) FROM sessions")
    with database.reader.begin() as reader:
        before = reader.scalar(count)
        with database.writer.begin() as writer:
            writer.execute(insert(sessions).values(SESSION))
        assert reader.scalar(count) == before == 0
    with database.reader.begin() as reader:
        assert reader.scalar(count) == 1


def test_a_transaction_that_fails_leaves_nothing(database: Database) -> None:
    def change() -> None:
        with database.writer.begin() as writer:
            writer.execute(insert(sessions).values(SESSION))
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        change()
    with database.reader.begin() as reader:
        assert reader.scalar(text("SELECT count(*) FROM sessions")) == 0


@pytest.mark.parametrize(
    "wrong",
    [
        "", "semtopo.db", "sqlite://", "sqlite:///", "sqlite:///:memory:", "mysql://localhost/x",
        "postgresql+asyncpg://localhost/x", "sqlite+aiosqlite:///x.db", "://", "sqlite:/x.db",
        "oracle://secret:password@host/x",
    ],
)  # fmt: skip
def test_a_wrong_url(wrong: str) -> None:
    with pytest.raises(InvalidDatabaseError) as caught:
        open_database(wrong)
    assert "password" not in str(caught.value)


@pytest.mark.parametrize(
    "right", ["postgresql://h/x", "postgres://h/x", "postgresql+psycopg://h/x", "sqlite:////a/b.db"]
)
def test_a_right_url(right: str) -> None:
    checked = module._checked(right)  # opening it would need a PostgreSQL
    assert checked.drivername in {"postgresql+psycopg", "sqlite"}
    assert checked.database == make_url(right).database


def test_a_file_that_cannot_be_opened(tmp_path: Path) -> None:
    with pytest.raises(StorageError):
        open_database(f"sqlite:///{tmp_path / 'no' / 'such' / 'folder' / 'x.db'}")


def test_a_file_that_is_no_database(tmp_path: Path) -> None:
    (tmp_path / "x.db").write_bytes(b"this is a letter, and no database" * 100)
    with pytest.raises(StorageError):
        open_database(f"sqlite:///{tmp_path / 'x.db'}")
    assert (tmp_path / "x.db").read_bytes().startswith(b"this is a letter")


@pytest.mark.parametrize(
    ("version", "journal"),
    [
        ((3, 40, 1), "DELETE"), ((3, 44, 5), "DELETE"), ((3, 44, 6), "WAL"), ((3, 45, 0), "DELETE"),
        ((3, 50, 6), "DELETE"), ((3, 50, 7), "WAL"), ((3, 51, 2), "DELETE"), ((3, 51, 3), "WAL"),
        ((3, 52, 0), "WAL"), ((4, 0, 0), "WAL"),
    ],
)  # fmt: skip
def test_a_sqlite_that_may_corrupt_gets_no_wal(
    version: tuple[int, int, int], journal: str, caplog: pytest.LogCaptureFixture
) -> None:
    driver = SimpleNamespace(sqlite_version_info=version, sqlite_version=str(version))
    with caplog.at_level(logging.WARNING):
        assert module._journal_mode(driver) == journal  # type: ignore[arg-type]
    assert ("WAL-reset" in caplog.text) == (journal == "DELETE")


class Locked:
    """A connection to a file that another process is just changing to another journal."""

    OperationalError = sqlite3.OperationalError

    def __init__(self, *answers: str) -> None:
        self.answers = list(answers)

    def execute(self, statement: str) -> None:
        assert statement == "PRAGMA journal_mode = WAL"
        if answer := self.answers.pop(0):
            raise sqlite3.OperationalError(answer)


def test_the_journal_mode_waits_for_others() -> None:
    connection = Locked("database is locked", "database is locked", "")
    module._set_journal(connection, "WAL")
    assert connection.answers == []
    with pytest.raises(sqlite3.OperationalError, match="disk"):
        module._set_journal(Locked("disk I/O error", ""), "WAL")


def test_the_journal_mode_does_not_wait_for_ever(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "_BUSY_MS", 30)
    with pytest.raises(sqlite3.OperationalError, match="locked"):
        module._set_journal(Locked(*["database is locked"] * 100), "WAL")


def test_without_the_bundled_sqlite(monkeypatch: pytest.MonkeyPatch, url: str) -> None:
    """The module that comes with Python does too, with the journal that suits its version."""
    monkeypatch.setattr(module, "bundled_sqlite", None)
    opened = open_database(url)
    wanted = module._journal_mode(sqlite3).lower()
    assert {found["journal_mode"] for found in pragmas(opened.reader)} == {wanted}
    assert {found["synchronous"] for found in pragmas(opened.reader)} == {2}
    opened.close()


# The schema


def test_migrations_lead_to_the_tables_that_the_code_knows(database: Database) -> None:
    with database.writer.connect() as connection:
        context = MigrationContext.configure(
            connection, opts={"compare_type": True, "render_as_batch": True}
        )
        assert compare_metadata(context, metadata) == []


def test_constraints_are_the_same_in_migrations_and_code(database: Database, url: str) -> None:
    """Alembic compares no checks, nor what a deletion takes along; so they are compared here."""
    migrated = inspect(database.writer)
    from_code = open_database(url.replace("semtopo.db", "code.db"))
    with from_code.writer.begin() as connection:
        command.downgrade(migration_config(connection), "base")
        metadata.create_all(connection)
    created = inspect(from_code.writer)
    for table in metadata.tables:
        assert normal(created.get_foreign_keys(table)) == normal(migrated.get_foreign_keys(table))
        assert normal(created.get_check_constraints(table)) == normal(
            migrated.get_check_constraints(table)
        )
        assert normal(created.get_unique_constraints(table)) == normal(
            migrated.get_unique_constraints(table)
        )
        assert normal(created.get_indexes(table)) == normal(migrated.get_indexes(table))
        assert created.get_pk_constraint(table) == migrated.get_pk_constraint(table)
    from_code.close()


def normal(found: object) -> list[str]:
    """Return descriptions in an order that does not depend on where they came from."""
    assert isinstance(found, list)
    return sorted(re.sub(r"\s+", " ", str(sorted(one.items()))) for one in found)


def test_down_to_nothing_and_up_again(database: Database) -> None:
    with database.writer.begin() as connection:
        command.downgrade(migration_config(connection), "base")
    assert set(inspect(database.writer).get_table_names()) <= {"alembic_version", "sqlite_sequence"}
    module.migrate(database.writer)
    assert set(metadata.tables) <= set(inspect(database.writer).get_table_names())


def test_opening_again_changes_nothing(url: str) -> None:
    open_database(url).close()
    before = dump(url)
    open_database(url).close()
    assert dump(url) == before


def dump(url: str) -> list[str]:
    with sqlite3.connect(url.removeprefix("sqlite:///")) as connection:
        lines = list(connection.iterdump())
    connection.close()
    return lines


OPEN_AT_ONCE = """
import os, sys, time
from service.database import open_database

for url in sys.argv[1:]:
    start = time.monotonic() + 0.2
    children = []
    for _ in range(6):
        child = os.fork()
        if child == 0:
            time.sleep(max(0, start - time.monotonic()))
            open_database(url).close()
            os._exit(0)
        children.append(child)
    assert [os.waitpid(child, 0)[1] for child in children] == [0] * 6
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")
def test_several_processes_open_a_new_database_at_once(url: str) -> None:
    """Each of them migrates, or waits for the one that does."""
    urls = [url.replace("semtopo", f"semtopo-{number}") for number in range(4)]
    command_line = [sys.executable, "-c", OPEN_AT_ONCE, *urls]
    done = subprocess.run(command_line, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[-3000:]
    for made in urls:
        assert any("CREATE TABLE sessions" in line for line in dump(made))


def test_alembic_at_the_command_line_finds_its_settings(url: str) -> None:
    alembic = Path(sys.executable).with_name("alembic")
    open_database(url).close()
    done = subprocess.run(
        [alembic, "current"],
        cwd=ROOT,
        env={"SEMTOPO_DATABASE": url},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert "0001 (head)" in done.stdout
