"""Routes, as they are answered."""

from __future__ import annotations

from pydantic import BaseModel

from semtopo.types import Point


class RoutePassage(BaseModel):
    """A passage on a route."""

    source: str
    target: str
    point: Point


class RouteAnswer(BaseModel):
    """A route; `length` in m along its passage points."""

    source: str
    target: str
    zones: list[str]
    passages: list[RoutePassage]
    length: float
