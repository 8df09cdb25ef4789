"""Errors, as they are answered."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import BaseModel

from semtopo.errors.ways import GroundlessPassage, MissingPassage, NearestFrontier
from semtopo.types import Point


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
    expected: int | str | None = None
    position: int | None = None
    example: str | None = None
    readings: list[str] | None = None
    closest: list[str] | None = None
    candidates: list[str] | None = None
    reachable: list[str] | None = None
    reaching: list[str] | None = None
    missing: MissingPassage | None = None
    frontier: NearestFrontier | None = None
    restricted: bool | None = None
    two_way: bool | None = None
    passage: GroundlessPassage | None = None
    end: Literal["start", "goal"] | None = None
    nearest: Point | None = None
    point: Point | None = None
    width: float | None = None
    needed: float | None = None


def problems(*statuses: int) -> dict[int | str, dict[str, Any]]:
    """Return the OpenAPI responses for errors of these statuses."""
    return {status: {"model": ProblemAnswer} for status in statuses}
