"""Run changes of the database in transactions, and say how they ended."""

from __future__ import annotations

import logging
from collections.abc import Callable
from contextlib import AbstractContextManager
from typing import Any

from sqlalchemy import Connection, Engine
from sqlalchemy.exc import SQLAlchemyError

from service.errors import StorageError

_log = logging.getLogger(__name__)

Change = Callable[[Connection], Any]
Begin = Callable[[], AbstractContextManager[Connection]]
Errors = tuple[type[Exception], ...]

Outcome = tuple[Any, Exception | None]
"""What a change returned, or how it failed."""

Committed = Callable[[int, float], None]
"""Hears of a transaction, in the thread that made it: how many changes, and how many s it took."""


def ignore(_changes: int, _seconds: float) -> None:
    """Hear nothing."""


def run_alone(begin: Begin, errors: Errors, change: Change) -> Outcome:
    """Run one change in a transaction of its own; return its result, or how it failed."""
    try:
        with begin() as connection:
            result = change(connection)
    except errors as error:
        return None, storage_failure(error)
    except Exception as error:  # noqa: BLE001 -- the thread must live; the caller is told
        return None, error
    return result, None


def database_errors(engine: Engine) -> Errors:
    """Return the errors of SQLAlchemy and of the driver below it."""
    driver = engine.dialect.dbapi
    return (SQLAlchemyError,) if driver is None else (SQLAlchemyError, driver.Error)


def storage_failure(error: Exception) -> StorageError:
    """Return what to tell of an error of the database, which is logged."""
    _log.warning("the database did not take a change: %s", error)
    failure = StorageError("the database did not take the change; it may be sent again")
    failure.__cause__ = error
    return failure
