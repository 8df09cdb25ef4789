"""Errors, as they are answered."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel


class Mistake(BaseModel):
    """One mistake in a request."""

    at: list[str]
    what: str


class ProblemAnswer(BaseModel):
    """An error (RFC 9457); programs may depend on `code`."""

    type: str
    title: str
    status: int
    code: str
    detail: str
    errors: list[Mistake] | None = None
    expected: int | None = None


def problems(*statuses: int) -> dict[int | str, dict[str, Any]]:
    """Return the OpenAPI responses for errors of these statuses."""
    return {status: {"model": ProblemAnswer} for status in statuses}
