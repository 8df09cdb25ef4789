"""Questions, and the routes that answer them."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, Field

from semtopo.documents import Document
from semtopo.types import Point

TEXT_MAX = 2_000  # characters of a question


class QueryRequest(Document):
    """A question in words."""

    text: Annotated[str, Field(strict=True, min_length=1, max_length=TEXT_MAX)]


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


class QueryAnswer(BaseModel):
    """The answer to a question."""

    kind: Literal["path"]
    sentence: str
    route: RouteAnswer
