"""Sessions, as they are asked for and told about."""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, BeforeValidator

from semtopo.documents import Document, Label, MappingDocument, SensorDocument, WorldDocument

ZONES_MAX = 10_000  # of a world; the library and the command take more


def _few_zones(given: object) -> object:
    """Refuse a world of too many zones, before each is looked at."""
    zones = given.get("zones") if isinstance(given, dict) else None
    if isinstance(zones, list) and len(zones) > ZONES_MAX:
        raise ValueError(f"a world has at most {ZONES_MAX} zones")
    return given


class SessionRequest(Document):
    """A new session: with a world, its sensor is simulated; without one, steps bring scans."""

    name: Label | None = None
    world: Annotated[WorldDocument | None, BeforeValidator(_few_zones)] = None
    sensor: SensorDocument = SensorDocument()
    mapping: MappingDocument = MappingDocument()


class WorldSummary(BaseModel):
    """A session's world in brief."""

    name: str
    zones: int


class SessionAnswer(BaseModel):
    """A session."""

    id: str
    name: str
    created_at: str
    seq: int
    sensor: SensorDocument
    mapping: MappingDocument
    world: WorldSummary | None


class SessionListed(BaseModel):
    """A session in a listing."""

    id: str
    name: str
    created_at: str
    seq: int


class SessionsAnswer(BaseModel):
    """A page of sessions; `next` is the cursor of the page that follows, if one does."""

    sessions: list[SessionListed]
    next: str | None
