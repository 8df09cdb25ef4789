"""Open the database: SQLite in a file, or PostgreSQL by URL, with its schema up to date.

Writers and readers get engines of their own. On SQLite there is one writing connection in all, and
a transaction takes the write lock when it begins; readers cannot write.
"""

from __future__ import annotations

import logging
import sqlite3
from dataclasses import dataclass, replace
from importlib import resources
from pathlib import Path
from time import monotonic, sleep
from types import ModuleType
from typing import Any

from alembic import command
from alembic.config import Config
from alembic.util import CommandError
from sqlalchemy import Connection, Engine, create_engine, event, make_url, text
from sqlalchemy.engine import URL
from sqlalchemy.exc import ArgumentError, OperationalError, SQLAlchemyError
from sqlalchemy.pool import StaticPool

from service.errors import InvalidDatabaseError, StorageError

try:
    from pysqlite3 import dbapi2 as bundled_sqlite
except ImportError:  # no wheel for this platform
    bundled_sqlite = None

_log = logging.getLogger(__name__)

_MIGRATION_LOCK = 7_305_001_921  # any number, the same in every process
_BUSY_MS = 5_000  # to wait for others that write to a SQLite file, or to the same rows
_POSTGRESQL_QUERY = {
    "connect_timeout": "5",  # s
    "tcp_user_timeout": "10000",  # ms; then a server that does not respond counts as gone
    # a process that stands still must not hold up the others for ever
    "options": f"-c lock_timeout={_BUSY_MS} -c idle_in_transaction_session_timeout=30000",
}
"""What a PostgreSQL URL asks for unless it says otherwise."""


@dataclass(frozen=True, slots=True)
class Database:
    """An open database: one engine that writes, one that reads."""

    writer: Engine
    reader: Engine
    glance: Connection | None = None
    """For single statements on the event loop; none where one might wait for a writer or a wire."""

    @property
    def single_writer(self) -> bool:
        """Whether all writing must go through one connection, as on SQLite."""
        return self.writer.dialect.name == "sqlite"

    def close(self) -> None:
        """Close all connections; the writer last, so that it is the one to checkpoint."""
        if self.glance is not None:
            self.glance.close()
        self.reader.dispose()
        self.writer.dispose()


def open_database(database: str) -> Database:
    """Open a database by its URL and bring its schema up to date.

    Raises
    ------
    InvalidDatabaseError
        The URL is none of `sqlite:///FILE` and `postgresql://...`.
    StorageError
        The file or the server cannot be reached, or its schema is not ours.
    """
    url = _checked(database)
    opened = _open_sqlite(url) if url.get_backend_name() == "sqlite" else _open_postgresql(url)
    try:
        migrate(opened.writer)
        glance = _glance(opened.reader)
    except (SQLAlchemyError, CommandError) as error:
        opened.close()
        cause = getattr(error, "orig", None) or error
        raise StorageError(f"the database cannot be opened: {cause}") from error
    return replace(opened, glance=glance)


def sqlite_file(database: str) -> Path | None:
    """Return the file of a SQLite database, `None` for PostgreSQL; raises InvalidDatabaseError."""
    url = _checked(database)
    return Path(str(url.database)) if url.get_backend_name() == "sqlite" else None


def sqlite_driver() -> ModuleType:
    """Return the module that speaks to SQLite: a bundled, recent one, if there is one."""
    return bundled_sqlite or sqlite3


def migrate(engine: Engine) -> None:
    """Bring the schema up to date; several processes may do so at once."""
    with engine.begin() as connection:
        if engine.dialect.name == "postgresql":
            lock = text("SELECT pg_advisory_xact_lock(:number)")
            connection.execute(text("SET LOCAL lock_timeout = 0"))  # however long it takes
            connection.execute(lock, {"number": _MIGRATION_LOCK})
        command.upgrade(migration_config(connection), "head")


def migration_config(connection: Connection) -> Config:
    """Return alembic's configuration for the migrations that come with this package."""
    config = Config()
    config.set_main_option("script_location", str(resources.files("migrations")))
    config.attributes["connection"] = connection
    return config


def _checked(database: str) -> URL:
    try:
        url = make_url(database)
    except ArgumentError:
        raise InvalidDatabaseError("the database URL cannot be read") from None
    if url.drivername == "sqlite" and url.database not in (None, "", ":memory:"):
        return url
    if url.drivername in ("postgresql", "postgres", "postgresql+psycopg"):
        return url.set(drivername="postgresql+psycopg")
    raise InvalidDatabaseError("the database must be sqlite:///FILE or postgresql://...")


def _open_postgresql(url: URL) -> Database:
    missing = {name: value for name, value in _POSTGRESQL_QUERY.items() if name not in url.query}
    writer = create_engine(
        url.update_query_dict(missing), pool_size=16, max_overflow=0, pool_pre_ping=True
    )
    # one reading sees one state, however many queries it makes; on SQLite that is always so
    reader = writer.execution_options(isolation_level="REPEATABLE READ", postgresql_readonly=True)
    return Database(writer, reader)


def _open_sqlite(url: URL) -> Database:
    driver = sqlite_driver()
    journal = _journal_mode(driver)
    options: dict[str, Any] = {"module": driver, "connect_args": {"check_same_thread": False}}
    writer = create_engine(url, poolclass=StaticPool, **options)
    reader = create_engine(url, pool_size=16 + 1, max_overflow=0, **options)  # with the glance
    for engine, begin in ((writer, "BEGIN IMMEDIATE"), (reader, "BEGIN")):
        _prepare_sqlite(engine, driver, begin, journal, query_only=engine is reader)
    return Database(writer, reader)


def _glance(reader: Engine) -> Connection | None:
    """Return a connection whose reading never waits: to SQLite with a write-ahead log alone."""
    if reader.dialect.name != "sqlite":
        return None
    connection = reader.connect()
    below: Any = connection.connection.driver_connection
    if below.execute("PRAGMA journal_mode").fetchone() != ("wal",):
        connection.close()
        return None
    below.execute("PRAGMA busy_timeout = 0")
    return connection


def _journal_mode(driver: ModuleType) -> str:
    """Return WAL, or DELETE for a SQLite whose WAL may corrupt a file (fixed in 3.51.3).

    The fault needs two connections to one file. It was also mended in 3.44.6 and 3.50.7.
    """
    version = driver.sqlite_version_info
    mended_since = {44: (3, 44, 6), 50: (3, 50, 7)}.get(version[1], (3, 51, 3))
    if version >= mended_since:
        return "WAL"
    _log.warning("SQLite %s has the WAL-reset bug: using a rollback journal", driver.sqlite_version)
    return "DELETE"


def _prepare_sqlite(
    engine: Engine, driver: ModuleType, begin: str, journal: str, *, query_only: bool
) -> None:
    """Make every connection durable and strict, and begin transactions explicitly."""

    @event.listens_for(engine, "connect")
    def set_up(connection: Any, _record: object) -> None:  # noqa: ANN401 -- either sqlite3 module
        connection.isolation_level = None  # or the module would begin transactions of its own
        connection.execute(f"PRAGMA busy_timeout = {_BUSY_MS}")
        _set_journal(connection, journal)
        connection.execute("PRAGMA synchronous = FULL")
        connection.execute("PRAGMA foreign_keys = ON")
        connection.execute(f"PRAGMA query_only = {query_only}")

    @event.listens_for(engine, "begin")
    def start(connection: Connection) -> None:
        # straight on the driver, which is 0.05 ms faster; the writer may have begun by itself
        below: Any = connection.connection.driver_connection
        if below.in_transaction:
            return
        try:
            below.execute(begin)
        except driver.Error as error:
            raise OperationalError(begin, None, error) from error


def _set_journal(connection: Any, journal: str) -> None:  # noqa: ANN401 -- either sqlite3 module
    """Set the journal mode; if another process just does so too, SQLite fails and does not wait."""
    give_up = monotonic() + _BUSY_MS / 1000
    while True:
        try:
            connection.execute(f"PRAGMA journal_mode = {journal}")
        except connection.OperationalError as error:
            if "locked" not in str(error) or monotonic() > give_up:
                raise
            sleep(0.01)
        else:
            return
