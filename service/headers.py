"""Find a header of a request: Starlette's way makes an object first, and reads all of them."""

from __future__ import annotations

from starlette.types import Scope


def find_header(scope: Scope, name: bytes) -> str | None:
    """Return the value of the first header of a name in lower case, as ASGI has them; or `None`."""
    for known, value in scope["headers"]:
        if known == name:
            found: str = value.decode("latin-1")
            return found
    return None
