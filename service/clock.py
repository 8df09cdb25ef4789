"""Tell the time, which the library never asks for."""

from __future__ import annotations

from datetime import UTC, datetime


def now() -> str:
    """Return the time, as `written` does."""
    return written(datetime.now(UTC))


def written(time: datetime) -> str:
    """Return a time in UTC: ISO 8601, milliseconds; so written, times sort as they follow."""
    return time.isoformat(timespec="milliseconds")


def seconds() -> float:
    """Return the time in s since the epoch."""
    return datetime.now(UTC).timestamp()
