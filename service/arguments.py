"""Find the arguments of endpoints: FastAPI alone needs up to 0.2 ms for that.

Such a route is described by its endpoint's signature like any other, and its arguments are checked
by the same rules. But JSON is read straight from its bytes, and nothing is looked for that the
endpoint does not take.
"""

from __future__ import annotations

import json
from collections.abc import Awaitable, Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, cast

from fastapi import Request, Response
from fastapi._compat import ModelField, is_scalar_field
from fastapi.dependencies.models import Dependant
from fastapi.exceptions import RequestValidationError
from fastapi.routing import APIRoute
from pydantic import TypeAdapter, ValidationError
from starlette.exceptions import HTTPException
from starlette.requests import ClientDisconnect
from starlette.routing import request_response
from starlette.types import Scope

from service.errors import InvalidRequestError
from service.headers import find_header

Mistakes = list[dict[str, Any]]

VALUES_MAX = 150_000
"""Commas and opening brackets of a body: a value of JSON takes up to 90 bytes of memory where it
takes 2 on the wire. A world of 10,000 zones has 90,000, a scan of 20,000 runs 64,000."""

MEMBERS_MAX = 50_000
"""Colons of a body: a member takes up to 300 bytes of memory, its name being a text of its own. A
world of 10,000 zones has 40,000."""

_MALFORMED = 400


class DirectRoute(APIRoute):
    """A route whose endpoint takes the request, parameters that may be left out, and a JSON body.

    Path parameters are given always. Where an endpoint takes anything else, such as a parameter of
    several values, the route is one of FastAPI.
    """

    def __init__(self, *given: Any, **more: Any) -> None:  # noqa: ANN401 -- as FastAPI calls it
        """Do without FastAPI's stacks of dependencies that must be closed: there are none."""
        super().__init__(*given, **more)
        takes = self.dependant
        self.is_direct = _is_direct(takes)
        if self.is_direct:
            self.app = request_response(_Endpoint(self.endpoint, takes).answer)


def _is_direct(takes: Dependant) -> bool:
    optional = [*takes.query_params, *takes.header_params]
    return (
        all(is_scalar_field(it) and not it.field_info.is_required() for it in optional)
        and len(takes.body_params) <= 1
        and not takes.cookie_params
        and not takes.dependencies
    )


@dataclass(frozen=True, slots=True)
class _Parameter:
    """A parameter of a path, a query or a header."""

    name: str
    where: str
    alias: str
    default: Any
    read: Callable[..., tuple[Any, Sequence[Any]]]

    @classmethod
    def all_of(cls, fields: Sequence[ModelField], where: str) -> list[_Parameter]:
        """Return the parameters that FastAPI found; their defaults are scalars, never changed."""
        return [cls(it.name, where, it.alias, it.get_default(), it.validate) for it in fields]


class _Endpoint:
    """An endpoint, and what it takes."""

    def __init__(self, call: Callable[..., Awaitable[Response]], takes: Dependant) -> None:
        """Take note of the parameters."""
        self._call = call
        self._path = _Parameter.all_of(takes.path_params, "path")
        self._query = _Parameter.all_of(takes.query_params, "query")
        self._headers = _Parameter.all_of(takes.header_params, "header")
        self._bodies: list[tuple[str, TypeAdapter[Any]]] = [
            (body.name, TypeAdapter(cast(Any, body.field_info.annotation)))
            for body in takes.body_params
        ]

    async def answer(self, request: Request) -> Response:
        """Call the endpoint, or raise RequestValidationError with all that is wrong."""
        mistakes: Mistakes = []
        found = _checked(self._path, request.path_params.get, mistakes)
        if self._query:
            found |= _checked(self._query, request.query_params.get, mistakes)
        found |= _checked(self._headers, partial(_header, request.scope), mistakes)
        for name, document in self._bodies:
            content = await _whole_body(request)
            try:
                found[name] = document.validate_json(content or b"null")
            except ValidationError as error:
                mistakes += _mistakes(error, "body")
        if mistakes:
            raise RequestValidationError(mistakes)
        return await self._call(request, **found)


def _header(scope: Scope, alias: str) -> str | None:
    return find_header(scope, alias.lower().encode())


async def _whole_body(request: Request) -> bytes:
    try:
        content = _utf8(await request.body())
    except (ClientDisconnect, UnicodeError):
        raise HTTPException(_MALFORMED) from None
    if len(content) > MEMBERS_MAX:
        if content.count(b":") > MEMBERS_MAX:
            raise InvalidRequestError(f"a body holds at most {MEMBERS_MAX} members")
        if sum(map(content.count, (b",", b"[", b"{"))) > VALUES_MAX:
            raise InvalidRequestError(f"a body holds at most {VALUES_MAX} values")
    return content


def _checked(
    wanted: Sequence[_Parameter], find: Callable[[str], str | None], mistakes: Mistakes
) -> dict[str, Any]:
    """Return the values of parameters by their names, and add what is wrong with them."""
    found = {}
    for parameter in wanted:
        text = find(parameter.alias)
        if text is None:
            found[parameter.name] = parameter.default
        else:
            value, wrong = parameter.read(text, loc=(parameter.where, parameter.alias))
            found[parameter.name] = value
            mistakes += wrong
    return found


def _mistakes(error: ValidationError, where: str) -> Mistakes:
    listed = error.errors(include_url=False, include_context=False, include_input=False)
    return [{**one, "loc": (where, *one["loc"])} for one in listed]


def _utf8(content: bytes) -> bytes:
    """Return JSON in UTF-8, in whatever Unicode it came (as `json.loads` takes it)."""
    encoding = json.detect_encoding(content)
    return content if encoding == "utf-8" else content.decode(encoding).encode()
