"""Print every table, and write them all as JSON: `make bench`.

Some alone: `make bench BENCH="worlds routes"`, or `python -m benchmarks worlds routes`.

Each module has a function `tables()`, which yields titles and rows as they are measured. All peers
of a table are measured in the same run; ratios are what counts. Peers that are no dependency are
looked for in the folder of `--peers`; tables tell which were not there. `make peers` puts them into
`.venv/peers`, which is looked into by itself.
"""

from __future__ import annotations

import argparse
import importlib
import sys
from pathlib import Path

import orjson
from rich.console import Console

from benchmarks.table import Row, show

MODULES = (
    "stages", "octave", "growth", "worlds", "routes", "dense_paths", "proved_paths",
    "http_steps", "durable_step", "reading", "memory", "many_sessions",
)  # fmt: skip
WIDTH = 180
"""Columns of text, where the output is no terminal."""


def main() -> None:
    """Measure what is asked for, or all."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("modules", nargs="*", default=MODULES, metavar="MODULE")
    parser.add_argument("--out", type=Path, default=Path("var/bench.json"))
    parser.add_argument("--peers", type=Path, default=Path(sys.prefix) / "peers")
    options = parser.parse_args()
    sys.path.append(str(options.peers))
    console = Console(width=None if sys.stdout.isatty() else WIDTH)
    found: dict[str, list[Row]] = {}
    for name in options.modules:
        for table in importlib.import_module(f"benchmarks.{name}").tables():
            show(console, table)
            found[table[0]] = table[1]
            options.out.parent.mkdir(parents=True, exist_ok=True)
            options.out.write_bytes(orjson.dumps(found, option=orjson.OPT_INDENT_2))


if __name__ == "__main__":
    main()
