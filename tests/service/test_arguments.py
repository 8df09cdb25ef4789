"""A direct route judges like one of FastAPI, and where it cannot, it is one."""

from __future__ import annotations

import asyncio
from typing import Annotated, Any, cast

import httpx2
import orjson
import pytest
from fastapi import APIRouter, Cookie, Depends, FastAPI, Query, Request, Response
from fastapi.routing import APIRoute
from hypothesis import given
from hypothesis import strategies as st
from pydantic import BaseModel

from service.arguments import DirectRoute
from service.parameters import AtStep, BoundingBox, IfNoneMatch, Limit, SessionId
from service.problems import register
from service.routes import maps, steps, views


class Point(BaseModel):
    """A body."""

    x: float
    y: float = 0.0


async def read(
    _request: Request,
    session_id: SessionId,
    if_none_match: IfNoneMatch = None,
    box: BoundingBox = None,
    at: AtStep = None,
    limit: Limit = 100,
) -> Response:
    """Tell what was understood."""
    return Response(orjson.dumps([session_id, if_none_match, box, at, limit]))


async def write(
    _request: Request, session_id: SessionId, point: Point, at: AtStep = None
) -> Response:
    """Tell what was understood."""
    return Response(orjson.dumps([session_id, point.model_dump(), at]))


def application(route_class: type[APIRoute]) -> FastAPI:
    router = APIRouter(route_class=route_class)
    router.get("/{session_id}")(read)
    router.post("/{session_id}")(write)
    made = FastAPI()
    register(made)
    made.router.routes.extend(router.routes)
    return made


OURS, THEIRS = application(DirectRoute), application(APIRoute)


def answer(app: FastAPI, method: str, address: str, **more: Any) -> tuple[int, bytes]:  # noqa: ANN401 -- as httpx takes it
    async def ask() -> httpx2.Response:
        transport = httpx2.ASGITransport(app=app)
        async with httpx2.AsyncClient(transport=transport, base_url="http://here") as client:
            return await client.request(method, address, **more)

    found = asyncio.run(ask())
    return found.status_code, found.content


IDS = st.sampled_from(["a", "A-b_9", "x" * 64, "x" * 65, "a.b", "%20"])
NAMES = st.sampled_from(["at", "bbox", "limit", "if_none_match", "session_id", "other"])
VALUES = st.sampled_from(
    ["", "0", "1", "-1", "1.0", "1e3", "1000", "1001", " 5 ", "nan", "true", "null", "0,0,1,1"]
) | st.text(alphabet="01,.-e x%\u00e9", max_size=110)
QUERIES = st.lists(st.tuples(NAMES, VALUES), max_size=4)
HEADERS = st.fixed_dictionaries(
    {}, optional={"If-None-Match": st.sampled_from(["", "*", '"1-2"', "x" * 1_000, "x" * 1_001])}
)


@given(IDS, QUERIES, HEADERS)
def test_a_reading_is_judged_as_fastapi_does(
    session_id: str, query: list[tuple[str, str]], headers: dict[str, str]
) -> None:
    ours, theirs = (
        answer(app, "GET", f"/{session_id}", params=query, headers=headers)
        for app in (OURS, THEIRS)
    )
    assert ours == theirs
    assert ours[0] in {200, 422}


@given(IDS, QUERIES, st.sampled_from([b'{"x": 1}', b'{"x": 1, "y": "a"}', b"{}", b"[]", b"1"]))
def test_a_body_is_judged_as_fastapi_does(
    session_id: str, query: list[tuple[str, str]], body: bytes
) -> None:
    headers = {"Content-Type": "application/json"}
    ours, theirs = (
        answer(app, "POST", f"/{session_id}", params=query, headers=headers, content=body)
        for app in (OURS, THEIRS)
    )
    assert ours[0] == theirs[0]
    assert ours[1] == theirs[1] or ours[0] == 422


def test_both_verdicts_are_met() -> None:
    verdicts = [
        ("/a?at=3&bbox=0,0,1,1&limit=7", 200), ("/a?at=1&at=2", 200), ("/a?at=-1", 422),
        ("/a?at=", 422), ("/a?limit=0", 422), ("/a.b", 422), ("/a?at=x&limit=x", 422),
    ]  # fmt: skip
    for address, status in verdicts:
        assert answer(OURS, "GET", address) == answer(THEIRS, "GET", address)
        assert answer(OURS, "GET", address)[0] == status
    assert answer(OURS, "GET", "/a?at=1&at=2")[1] == b'["a",null,null,2,100]'


async def several(name: Annotated[list[str], Query()] = []) -> Response:  # noqa: B006 -- FastAPI copies it
    """Take several values of one name."""
    return Response(orjson.dumps(name))


async def required(name: str) -> Response:
    """Take what must be given."""
    return Response(orjson.dumps(name))


async def cookie(name: Annotated[str, Cookie()] = "") -> Response:
    """Take a cookie."""
    return Response(orjson.dumps(name))


async def dependent(name: Annotated[str, Depends(lambda: "b")]) -> Response:
    """Take what a function returns."""
    return Response(orjson.dumps(name))


@pytest.mark.parametrize("endpoint", [several, required, cookie, dependent])
def test_other_endpoints_are_those_of_fastapi(endpoint: Any) -> None:  # noqa: ANN401 -- any of them
    router = APIRouter(route_class=DirectRoute)
    router.get("/")(endpoint)
    assert not cast(DirectRoute, router.routes[0]).is_direct
    made = FastAPI()
    made.router.routes.extend(router.routes)
    given_cookie = {"Cookie": "name=b"}
    status, body = answer(made, "GET", "/?name=a&name=b", headers=given_cookie)
    assert (status, body) == (200, b'["a","b"]' if endpoint is several else b'"b"')
    if endpoint is required:
        assert answer(made, "GET", "/")[0] == 422


@pytest.mark.parametrize("room", [maps, steps, views])
def test_what_is_asked_for_often_is_direct(room: Any) -> None:  # noqa: ANN401 -- a module
    for route in cast(list[DirectRoute], room.router.routes):
        assert route.is_direct
