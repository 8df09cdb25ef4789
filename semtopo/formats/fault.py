"""Say in one line what is wrong with a document; never repeat at length what came in."""

from __future__ import annotations

from pydantic import ValidationError

PLACE_LENGTH_MAX = 80


def describe_fault(error: ValidationError) -> str:
    """Return where the first fault of a document is, and what it is, in one line."""
    fault = error.errors(include_url=False, include_context=False, include_input=False)[0]
    place = ".".join(map(str, fault["loc"]))
    message = fault["msg"].removeprefix("Value error, ")
    return f"{_clipped(place)}: {message}" if place else message


def _clipped(place: str) -> str:
    """Return a place in a document, short and on one line: its last part may be a foreign key."""
    line = "".join(sign if sign.isprintable() else "?" for sign in place)
    return line if len(line) <= PLACE_LENGTH_MAX else line[:PLACE_LENGTH_MAX] + "..."
