"""Copy the database of a service, which may be running and taking steps meanwhile."""

from __future__ import annotations

import os
import tempfile
from contextlib import closing
from pathlib import Path

from service.database import sqlite_driver, sqlite_file
from service.errors import InvalidDatabaseError, StorageError


def back_up(url: str, file: Path) -> int:
    """Write a SQLite database, as it is at one moment, into a new file; return its size in bytes.

    Raises
    ------
    InvalidDatabaseError
        The URL is not that of a SQLite file, or no file of ours is there.
    StorageError
        The database cannot be read, or the file not be written.
    FileExistsError
        There is such a file.
    """
    source = sqlite_file(url)
    if source is None:
        raise InvalidDatabaseError("only SQLite is copied here; for PostgreSQL, use pg_dump")
    if not source.is_file():
        raise InvalidDatabaseError(f"there is no database in {source}")
    if file.exists():
        raise FileExistsError(17, "there is such a file already", str(file))
    with tempfile.TemporaryDirectory(prefix=".semtopo-", dir=file.parent) as folder:
        copy = Path(folder) / "copy"
        _copy(source, copy)
        with copy.open("rb") as written:
            os.fsync(written.fileno())
        copy.rename(file)
    return file.stat().st_size


def _copy(source: Path, copy: Path) -> None:
    """Copy in one reading, which sees one moment; who writes to a WAL need not wait for it."""
    driver = sqlite_driver()
    try:
        with closing(driver.connect(source, timeout=60)) as connection:
            connection.execute("PRAGMA query_only = ON")
            connection.execute("SELECT count(*) FROM sessions")  # else it is not ours
            with closing(driver.connect(copy)) as target:
                connection.backup(target)
                target.execute("PRAGMA journal_mode = DELETE")  # so that it is one file
    except driver.Error as error:
        raise StorageError(f"{source} cannot be copied: {error}") from error
