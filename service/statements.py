"""Run the statements of a step straight on the driver.

SQLAlchemy writes the SQL, once for each database; but to execute a statement through it costs about
0.3 ms, some five times what the database itself takes, and a step needs several.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, cast

from sqlalchemy import Connection, Dialect
from sqlalchemy.sql.compiler import SQLCompiler
from sqlalchemy.sql.elements import ClauseElement


class Statement:
    """A statement, compiled once for each kind of database."""

    def __init__(self, statement: ClauseElement) -> None:
        """Keep the statement."""
        self._statement = statement
        self._compiled: dict[str, SQLCompiler] = {}

    def compiled(self, dialect: Dialect) -> SQLCompiler:
        """Return the statement in the SQL of a database."""
        known = self._compiled.get(dialect.name)
        if known is None:
            known = cast(SQLCompiler, self._statement.compile(dialect=dialect))
            self._compiled[dialect.name] = known
        return known


def run(connection: Connection, statement: Statement, values: Mapping[str, Any]) -> int:
    """Execute a statement with values for its parameters; return how many rows it changed.

    An error is the driver's own, not one of SQLAlchemy's.
    """
    changed: int = _executed(connection, statement, values).rowcount
    return changed


def find(
    connection: Connection, statement: Statement, values: Mapping[str, Any]
) -> tuple[Any, ...] | None:
    """Execute a query for one row; return its columns, or `None` if there is none."""
    row: tuple[Any, ...] | None = _executed(connection, statement, values).fetchone()
    return row


def _executed(connection: Connection, statement: Statement, values: Mapping[str, Any]) -> Any:  # noqa: ANN401 -- a cursor of either driver
    compiled = statement.compiled(connection.dialect)
    if compiled.positiontup is None:
        given: Any = {name: values[name] for name in compiled.bind_names.values()}
    else:
        given = [values[name] for name in compiled.positiontup]
    driver: Any = connection.connection.driver_connection
    return driver.execute(compiled.string, given)
