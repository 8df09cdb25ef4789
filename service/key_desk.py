"""Make, revoke and list API keys in the database of a service, which may be running."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from sqlalchemy import Connection

from service.clock import now
from service.database import open_database
from service.keys import add_key, list_keys, revoke_key
from service.settings import Settings


def add(url: str | None, name: str) -> str:
    """Make a key of that name, and return it; see `keys.add_key`."""
    with _connection(url) as connection:
        return add_key(connection, name, now())


def revoke(url: str | None, name: str) -> None:
    """Make the key of that name invalid; see `keys.revoke_key`."""
    with _connection(url) as connection:
        revoke_key(connection, name, now())


def listed(url: str | None) -> list[str]:
    """Return a line for each key: its name, and when it was made and revoked."""
    with _connection(url) as connection:
        return [
            f"{key.name}\t{key.created_at}\t{key.revoked_at or 'valid'}"
            for key in list_keys(connection)
        ]


@contextmanager
def _connection(url: str | None) -> Iterator[Connection]:
    """Give a connection in a transaction that is committed at the end."""
    database = open_database(Settings().database if url is None else url)
    try:
        with database.writer.begin() as connection:
            yield connection
    finally:
        database.close()
