"""Turn headers and parameters into values, or refuse them.

All of it is `async`, though nothing is awaited: FastAPI would run plain functions in threads.
"""

from __future__ import annotations

import re
from typing import Annotated

from fastapi import Depends, Header, Path, Query, Request

from semtopo.codec import Box
from semtopo.documents import COORDINATE_MAX, LABEL_LENGTH_MAX
from service.errors import InvalidRequestError, UnauthorizedError, UnknownSessionError
from service.schemas import SEQ_MAX
from service.sessions import Sessions

_KEY = re.compile(r'"([\x21\x23-\x7e]{1,255})"|([\x21\x23-\x7e]{1,255})')
_TAGS = re.compile(r'\s*((W/)?"[\x21\x23-\x7e]{0,100}"|\*)\s*')
_NUMBER = re.compile(r"-?\d{1,15}(\.\d{1,15})?")


async def sessions_of(request: Request) -> Sessions:
    """Return the sessions of the application."""
    found: Sessions = request.app.state.sessions
    return found


async def idempotency_key(
    key: Annotated[str | None, Header(alias="Idempotency-Key", max_length=257)] = None,
) -> str | None:
    """Return the Idempotency-Key: up to 255 visible characters, quoted or bare."""
    if key is None:
        return None
    found = _KEY.fullmatch(key)
    if found is None:
        raise InvalidRequestError("Idempotency-Key must be up to 255 visible ASCII characters")
    return found[1] or found[2]


async def if_match(
    tags: Annotated[str | None, Header(alias="If-Match", max_length=1_000)] = None,
) -> frozenset[str] | None:
    """Return the entity tags of If-Match."""
    return _entity_tags(tags, "If-Match")


async def if_none_match(
    tags: Annotated[str | None, Header(alias="If-None-Match", max_length=1_000)] = None,
) -> frozenset[str]:
    """Return the entity tags of If-None-Match, strong or weak (RFC 9110, 13.1.2)."""
    found = _entity_tags(tags, "If-None-Match") or frozenset()
    return frozenset(tag.removeprefix("W/") for tag in found)


async def bounding_box(
    bbox: Annotated[
        str | None,
        Query(max_length=100, description="least x, least y, greatest x, greatest y, in m"),
    ] = None,
) -> Box | None:
    """Return the bounding box, in m."""
    if bbox is None:
        return None
    parts = bbox.split(",")
    if len(parts) != 4 or not all(map(_NUMBER.fullmatch, parts)):  # noqa: PLR2004 -- two corners
        raise InvalidRequestError("bbox must be four numbers with commas between")
    left, low, right, high = map(float, parts)
    if left > right or low > high or max(map(abs, (left, low, right, high))) > COORDINATE_MAX:
        raise InvalidRequestError("bbox must be least x, least y, greatest x, greatest y, in m")
    return (left, low, right, high)


def _entity_tags(header: str | None, name: str) -> frozenset[str] | None:
    if header is None:
        return None
    found = [_TAGS.fullmatch(tag) for tag in header.split(",")]
    if None in found:
        raise InvalidRequestError(f"{name} must be * or entity tags in double quotes")
    return frozenset(tag[1] for tag in found if tag is not None)


SessionsOf = Annotated[Sessions, Depends(sessions_of)]


async def owner_of(
    request: Request,
    sessions: SessionsOf,
    bearer: Annotated[str | None, Header(alias="Authorization", max_length=200)] = None,
) -> int | None:
    """Return the number of the API key that was sent; none where no key is asked for."""
    if not request.app.state.settings.keys:
        return None
    scheme, _, key = (bearer or "").partition(" ")
    if scheme.lower() != "bearer":
        raise UnauthorizedError("send an API key: Authorization: Bearer KEY")
    return await sessions.authenticate(key.strip())


Owner = Annotated[int | None, Depends(owner_of)]


async def session_of(
    sessions: SessionsOf,
    owner: Owner,
    session_id: Annotated[
        str, Path(pattern=r"^[A-Za-z0-9_-]{1,64}$", description="the id of a session")
    ],
) -> str:
    """Return the id of a session, if the caller may see it; else it is as if it did not exist."""
    if owner is not None and (await sessions.find(session_id)).row.owner != owner:
        raise UnknownSessionError("there is no session of that id")
    return session_id


SessionId = Annotated[str, Depends(session_of)]
IdempotencyKey = Annotated[str | None, Depends(idempotency_key)]
IfMatch = Annotated[frozenset[str] | None, Depends(if_match)]
IfNoneMatch = Annotated[frozenset[str], Depends(if_none_match)]
BoundingBox = Annotated[Box | None, Depends(bounding_box)]
AtStep = Annotated[
    int | None, Query(alias="at", ge=0, le=SEQ_MAX, description="as of this step; now if left out")
]
AfterStep = Annotated[int, Query(alias="after", ge=0, le=SEQ_MAX)]
Limit = Annotated[int, Query(ge=1, le=1_000)]
ZoneName = Annotated[str, Query(min_length=1, max_length=LABEL_LENGTH_MAX)]
