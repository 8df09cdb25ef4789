"""Print every table, and write them all as JSON: `make bench`.

Each module has a function `tables()`, which yields titles and rows as they are measured. All peers
of a table are measured in the same run; ratios are what counts.
"""

from __future__ import annotations

import argparse
import importlib
from pathlib import Path

import orjson
from rich.console import Console
from rich.table import Table

MODULES = ("stages", "growth", "worlds", "reading", "dense_paths", "routes")


def show(console: Console, title: str, rows: list[dict[str, str]]) -> None:
    """Print one table."""
    table = Table(title=title, title_justify="left")
    for number, name in enumerate(rows[0]):
        table.add_column(name, justify="right" if number else "left")
    for row in rows:
        table.add_row(*row.values())
    console.print(table)


def main() -> None:
    """Measure what is asked for, or all."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("modules", nargs="*", default=MODULES)
    parser.add_argument("--out", type=Path, default=Path("var/bench.json"))
    options = parser.parse_args()
    console = Console()
    found: dict[str, list[dict[str, str]]] = {}
    for name in options.modules:
        for title, rows in importlib.import_module(f"benchmarks.{name}").tables():
            show(console, title, rows)
            found[title] = rows
            options.out.parent.mkdir(parents=True, exist_ok=True)
            options.out.write_bytes(orjson.dumps(found, option=orjson.OPT_INDENT_2))


if __name__ == "__main__":
    main()
