"""A table: a title, and rows that name their cells. The rows of one table have the same names."""

from __future__ import annotations

from typing import TypeAlias

from rich.console import Console
from rich.table import Table as Drawn

Row: TypeAlias = dict[str, str]
"""Name of a column to a cell."""

Table: TypeAlias = tuple[str, list[Row]]
"""A title, and rows."""


def show(console: Console, table: Table) -> None:
    """Print a table."""
    title, rows = table
    drawn = Drawn()
    for number, name in enumerate(rows[0]):
        drawn.add_column(name, justify="right" if number else "left")
    for row in rows:
        drawn.add_row(*row.values())
    console.print(title, markup=False, highlight=False, soft_wrap=True)
    console.print(drawn)


def skipped(title: str, reason: str) -> Table:
    """Return what stands where a table would, had this machine what it needs."""
    return (title, [{"not measured": reason}])
