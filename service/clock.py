"""Tell the time, which the library never asks for."""

from __future__ import annotations

from datetime import UTC, datetime


def now() -> str:
    """Return the time: ISO 8601, UTC, milliseconds."""
    return datetime.now(UTC).isoformat(timespec="milliseconds")


def seconds() -> float:
    """Return the time in s since the epoch."""
    return datetime.now(UTC).timestamp()
