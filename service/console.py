"""The part of the command `semtopo` that runs the service: serve it, give keys, back it up.

FastAPI and SQLAlchemy take a second to import, which the rest of the command need not wait for. So
each of these imports what it needs when it is called.
"""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import typer

app = typer.Typer()

DatabaseOption = Annotated[str | None, typer.Option(help="URL, as SQLAlchemy writes it.")]


class KeyAction(StrEnum):
    """What can be done with API keys."""

    ADD = "add"
    LIST = "list"
    REVOKE = "revoke"


@app.command()
def serve(
    *,
    host: Annotated[str | None, typer.Option(show_default="127.0.0.1")] = None,
    port: Annotated[int | None, typer.Option(show_default="8000")] = None,
    database: DatabaseOption = None,
    example: Annotated[Path | None, typer.Option(help="Folder of world.json and path.csv.")] = None,
    keys: Annotated[bool, typer.Option("--keys", help="Ask every request for an API key.")] = False,
    is_open: Annotated[bool, typer.Option("--open", help="Serve other machines without.")] = False,
) -> None:
    """Serve maps over HTTP. What is not given here is read from SEMTOPO_... variables."""
    from service.app import serve as serve_forever  # noqa: PLC0415
    from service.settings import Settings  # noqa: PLC0415

    given: dict[str, Any] = {
        "host": host, "port": port, "database": database, "example": example,
        "keys": keys or None, "open": is_open or None,
    }  # fmt: skip
    serve_forever(Settings(**{name: value for name, value in given.items() if value is not None}))


@app.command()
def keys(
    action: Annotated[KeyAction, typer.Argument()],
    name: Annotated[str, typer.Argument(help="Whose key; not for `list`.")] = "",
    *,
    database: DatabaseOption = None,
) -> None:
    """Make, revoke or list API keys. A new key is shown this once."""
    from service.key_desk import add, listed, revoke  # noqa: PLC0415

    match action:
        case KeyAction.ADD:
            typer.echo(add(database, name))
        case KeyAction.REVOKE:
            revoke(database, name)
        case KeyAction.LIST:
            for line in listed(database):
                typer.echo(line)


@app.command()
def backup(
    file: Annotated[Path, typer.Argument(help="A new file.", show_default=False)],
    *,
    database: DatabaseOption = None,
) -> None:
    """Copy a SQLite database into FILE, also while it is served. For PostgreSQL, use pg_dump."""
    from service.backup import back_up  # noqa: PLC0415
    from service.settings import Settings  # noqa: PLC0415

    size = back_up(Settings().database if database is None else database, file)
    typer.echo(f"{file}: {size} bytes")
