"""Worlds as JSON: `{"name"?, "zones": [{"label", "kind", "low", "high"}, ...]}`, in m."""

from __future__ import annotations

from pydantic import ValidationError

from semtopo.documents import WorldDocument
from semtopo.errors import InvalidWorldError
from semtopo.formats.fault import describe_fault
from semtopo.world import World


def read_world(content: bytes) -> World:
    """Return the world of a JSON file.

    Raises
    ------
    InvalidWorldError
        It is no JSON, holds no zone, or a field is missing, unknown or out of range.
    """
    try:
        return WorldDocument.model_validate_json(content).value()
    except ValidationError as error:
        raise InvalidWorldError(describe_fault(error)) from None
