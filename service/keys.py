"""API keys: who may use a service that listens beyond its own machine.

A key is shown once, when it is made. Stored is its SHA-256: a key holds 256 random bits, so no slow
hash is needed to keep it from being guessed. Whoever has a key sees the sessions made with it, and
no others.
"""

from __future__ import annotations

import hashlib
import hmac
import secrets
from dataclasses import dataclass

from sqlalchemy import Connection, insert, select, update

from service.errors import InvalidKeyNameError, UnauthorizedError, UnknownKeyError
from service.tables import api_keys

_PREFIX = "semtopo"
_ID_BYTES, _SECRET_BYTES = 6, 32


@dataclass(frozen=True, slots=True)
class KeyRow:
    """A key as it is listed: its name, and when it was made and revoked."""

    name: str
    created_at: str
    revoked_at: str | None


def add_key(connection: Connection, name: str, created_at: str) -> str:
    """Make a key, and return it; it cannot be read again.

    Raises
    ------
    InvalidKeyNameError
        A key of that name exists, or the name is empty.
    """
    taken = select(api_keys.c.number).where(api_keys.c.name == name)
    if not name.strip() or connection.execute(taken).first() is not None:
        raise InvalidKeyNameError("a key needs a name of its own")
    identifier, secret = secrets.token_hex(_ID_BYTES), secrets.token_urlsafe(_SECRET_BYTES)
    values = {"id": identifier, "name": name, "digest": _digest(secret), "created_at": created_at}
    connection.execute(insert(api_keys).values(values))
    return f"{_PREFIX}_{identifier}_{secret}"


def revoke_key(connection: Connection, name: str, revoked_at: str) -> None:
    """Make a key invalid; its sessions stay.

    Raises
    ------
    UnknownKeyError
        No valid key has that name.
    """
    valid = (api_keys.c.name == name) & api_keys.c.revoked_at.is_(None)
    changed = connection.execute(update(api_keys).where(valid).values(revoked_at=revoked_at))
    if changed.rowcount == 0:
        raise UnknownKeyError("there is no valid key of that name")


def list_keys(connection: Connection) -> list[KeyRow]:
    """Return all keys, oldest first."""
    columns = (api_keys.c.name, api_keys.c.created_at, api_keys.c.revoked_at)
    query = select(*columns).order_by(api_keys.c.number)
    return [KeyRow(**row) for row in connection.execute(query).mappings()]


def authenticate(connection: Connection, key: str) -> int:
    """Return the number of a key.

    Raises
    ------
    UnauthorizedError
        It is none, or one that was revoked.
    """
    prefix, _, rest = key.partition("_")
    identifier, _, secret = rest.partition("_")
    query = select(api_keys.c.number, api_keys.c.digest).where(
        api_keys.c.id == identifier, api_keys.c.revoked_at.is_(None)
    )
    row = connection.execute(query).one_or_none()
    # compared also where there is no such key, so that the time taken tells nothing
    stored = bytes(32) if row is None else row.digest
    fits = hmac.compare_digest(_digest(secret), stored)
    if row is None or not fits or prefix != _PREFIX:
        raise UnauthorizedError("this API key is not valid")
    number: int = row.number
    return number


def _digest(secret: str) -> bytes:
    return hashlib.sha256(secret.encode()).digest()
