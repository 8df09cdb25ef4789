"""Say how a service runs: from arguments, else from environment variables `SEMTOPO_...`."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

from pydantic import Field
from pydantic_settings import BaseSettings, SettingsConfigDict


class Settings(BaseSettings):
    """Where to listen, where to store, and how much to bear."""

    model_config = SettingsConfigDict(env_prefix="SEMTOPO_", frozen=True)

    host: str = "127.0.0.1"
    port: int = Field(default=8000, ge=0, le=65_535)
    database: str = "sqlite:///semtopo.db"
    example: Path | None = None
    """A folder with world.json and path.csv, made ready as the session `example`."""

    keys: bool = False
    """Whether every request must bring an API key."""

    open: bool = False
    """Whether to listen beyond this machine without asking for keys."""

    body_bytes_max: int = Field(default=2**20, ge=1024)
    """The largest request body: a scan of 4,000 beams, or a world of 10,000 zones, takes less."""

    hot_sessions_max: int = Field(default=256, ge=1)
    """How many sessions stay in memory, with their maps and worlds."""

    hot_bytes_max: int = Field(default=2**28, ge=0)
    """What they may take together: a zone of a world 1.3 kB, a map of 5,000 vertices 0.2 MB."""

    cached_bodies_max: int = Field(default=512, ge=1)
    """How many bodies of zones stay in memory."""

    cached_bytes_max: int = Field(default=2**26, ge=0)
    """What they may take together."""

    past_maps_max: int = Field(default=1_024, ge=1)
    """How many earlier maps stay in memory."""

    past_bytes_max: int = Field(default=2**26, ge=0)
    """What they may take together, if none had anything in common with another."""

    queue_max: int = Field(default=1_000, ge=1)
    """How many steps may wait; the next one is asked to come again."""

    connections_max: int = Field(default=4_000, ge=1)
    """How many connections may be open; the next one is answered 503 and closed."""

    keep_days: float | None = Field(default=None, gt=0, le=36_500)
    """After how many days without a step a session is deleted; never, if not given."""

    log: Literal["json", "text"] = "json"
    """How to log: a JSON object a line, or plain text."""

    readers_max: int = Field(default=2_000, ge=1)
    """How many readers of events may be connected."""
