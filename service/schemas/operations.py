"""How the service is."""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel


class HealthAnswer(BaseModel):
    """The service is well."""

    status: Literal["ok"]
