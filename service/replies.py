"""Answer with bytes that are written already, or with 304 where the client has them."""

from __future__ import annotations

from collections.abc import Callable

from fastapi import Response
from fastapi.responses import JSONResponse

from service.maps import Body
from service.parameters import is_known


class JsonBytes(Response):
    """JSON that is written already."""

    media_type = "application/json"


class GeoJsonBytes(JSONResponse):
    """GeoJSON that is written already."""

    media_type = "application/geo+json"

    def render(self, content: bytes) -> bytes:
        """Return it as it is."""
        return content


def unless_known(kind: Callable[..., Response], body: Body, if_none_match: str | None) -> Response:
    """Return a body with its entity tag, or 304 if the client has it (RFC 9110, 13.1.2)."""
    headers = {"ETag": body.tag, "Cache-Control": "no-cache"}
    if is_known(if_none_match, body.tag):
        return Response(status_code=304, headers=headers)
    return kind(body.content, headers=headers)
