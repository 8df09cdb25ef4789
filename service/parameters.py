"""Turn headers and parameters into values, or refuse them.

Endpoints call these functions themselves. As dependencies of FastAPI they would cost a step more
time than its commit does.
"""

from __future__ import annotations

import re
from typing import Annotated

from fastapi import Header, Path, Query, Request

from semtopo.documents import COORDINATE_MAX, LABEL_LENGTH_MAX
from semtopo.geometry import Box
from service.changes import Changes
from service.errors import InvalidRequestError
from service.feeds import Feeds
from service.maps import Maps
from service.pictures import Pictures
from service.schemas.steps import SEQ_MAX
from service.sessions import Sessions
from service.steps import Steps

_KEY = re.compile(r'"([\x21\x23-\x7e]{1,255})"|([\x21\x23-\x7e]{1,255})')
_TAGS = re.compile(r'\s*((W/)?"[\x21\x23-\x7e]{0,100}"|\*)\s*')
_NUMBER = re.compile(r"-?\d{1,15}(\.\d{1,15})?")


def sessions_of(request: Request) -> Sessions:
    """Return the sessions of the application."""
    found: Sessions = request.app.state.sessions
    return found


def steps_of(request: Request) -> Steps:
    """Return the steps of the application."""
    found: Steps = request.app.state.steps
    return found


def maps_of(request: Request) -> Maps:
    """Return the maps of the application."""
    found: Maps = request.app.state.maps
    return found


def changes_of(request: Request) -> Changes:
    """Return the changes of the application."""
    found: Changes = request.app.state.changes
    return found


def feeds_of(request: Request) -> Feeds:
    """Return the feeds of the application."""
    found: Feeds = request.app.state.feeds
    return found


def owner_of(request: Request) -> int | None:
    """Return the number of the API key that was sent; none where no key is asked for."""
    owner: int | None = getattr(request.state, "owner", None)
    return owner


def pictures_of(request: Request) -> Pictures:
    """Return the pictures of the application."""
    found: Pictures = request.app.state.pictures
    return found


def idempotency_key(header: str | None) -> str | None:
    """Return the key of an Idempotency-Key: up to 255 visible characters, quoted or bare."""
    if header is None:
        return None
    found = _KEY.fullmatch(header)
    if found is None:
        raise InvalidRequestError("Idempotency-Key must be up to 255 visible ASCII characters")
    return found[1] or found[2]


def entity_tags(header: str | None) -> frozenset[str] | None:
    """Return the entity tags of If-Match or If-None-Match (RFC 9110, 13.1)."""
    if header is None:
        return None
    found = [_TAGS.fullmatch(tag) for tag in header.split(",")]
    if None in found:
        raise InvalidRequestError("expected * or entity tags in double quotes")
    return frozenset(tag[1] for tag in found if tag is not None)


def is_known(header: str | None, tag: str) -> bool:
    """Say whether If-None-Match names an entity tag, strong or weak (RFC 9110, 13.1.2)."""
    tags = entity_tags(header) or frozenset()
    return bool({known.removeprefix("W/") for known in tags} & {tag, "*"})


def bounding_box(bbox: str | None) -> Box | None:
    """Return the bounding box, in m, of four numbers with commas between."""
    if bbox is None:
        return None
    parts = bbox.split(",")
    if len(parts) != 4 or not all(map(_NUMBER.fullmatch, parts)):  # noqa: PLR2004 -- two corners
        raise InvalidRequestError("bbox must be four numbers with commas between")
    left, low, right, high = map(float, parts)
    if left > right or low > high or max(map(abs, (left, low, right, high))) > COORDINATE_MAX:
        raise InvalidRequestError("bbox must be least x, least y, greatest x, greatest y, in m")
    return (left, low, right, high)


SessionId = Annotated[
    str, Path(pattern=r"^[A-Za-z0-9_-]{1,64}$", description="the id of a session")
]
IdempotencyKey = Annotated[
    str | None,
    Header(alias="Idempotency-Key", max_length=257, description="a retry gets the first answer"),
]
IfMatch = Annotated[str | None, Header(alias="If-Match", max_length=1_000)]
IfNoneMatch = Annotated[str | None, Header(alias="If-None-Match", max_length=1_000)]
BoundingBox = Annotated[
    str | None,
    Query(
        alias="bbox",
        max_length=100,
        description="least x, least y, greatest x, greatest y, in m",
    ),
]
Tolerance = Annotated[
    float,
    Query(
        ge=0,
        le=COORDINATE_MAX,
        allow_inf_nan=False,
        description="lines need be no nearer to the real ones, in m",
    ),
]
AtStep = Annotated[
    int | None, Query(alias="at", ge=0, le=SEQ_MAX, description="as of this step; now if left out")
]
SinceStep = Annotated[
    int | None,
    Query(
        alias="since",
        ge=0,
        le=SEQ_MAX,
        description="only what later steps changed, and in `total` how many there are",
    ),
]
AfterStep = Annotated[int, Query(alias="after", ge=0, le=SEQ_MAX)]
Limit = Annotated[int, Query(ge=1, le=1_000)]
ZoneName = Annotated[str, Query(min_length=1, max_length=LABEL_LENGTH_MAX)]
