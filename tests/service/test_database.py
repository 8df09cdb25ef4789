"""Opening a database: which URLs there are, and how SQLite is made durable and strict."""

from __future__ import annotations

import logging
import sqlite3
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace

import pytest
from sqlalchemy import Engine, make_url, text

from service import database as module
from service.database import Database, open_database
from service.errors import InvalidDatabaseError, StorageError

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
