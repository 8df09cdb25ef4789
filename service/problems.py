"""Say what went wrong as `application/problem+json` (RFC 9457), with a stable `code`.

Domain errors know no HTTP: `STATUS` alone maps them to statuses, and a test sees to it that it is
complete. No answer repeats what came in, and none shows the inside of the server.
"""

from __future__ import annotations

from typing import Any

import orjson
from fastapi import FastAPI, Request, Response
from fastapi.exceptions import RequestValidationError
from sqlalchemy.exc import DBAPIError
from sqlalchemy.exc import TimeoutError as PoolTimeoutError
from starlette.exceptions import HTTPException
from starlette.routing import Match

from semtopo.errors import (
    AmbiguousQuestionError,
    AmbiguousZoneError,
    InvalidInputError,
    InvalidMapError,
    NotExportableError,
    SemtopoError,
    UnknownBorderError,
    UnknownPositionError,
    UnknownStepError,
    UnknownZoneError,
)
from semtopo.errors.ways import (
    NoRouteError,
    NotConnectedError,
    OutsideError,
    TooNarrowError,
    UnprovedPathError,
)
from service.errors import (
    BusyError,
    InvalidDatabaseError,
    InvalidRequestError,
    KeyReusedError,
    MapFullError,
    NameTakenError,
    NotesFullError,
    NoWorldError,
    PictureError,
    SequenceGapError,
    SequenceReusedError,
    StorageError,
    UnauthorizedError,
    UnknownKeyError,
    UnknownPassageError,
    UnknownRestrictionError,
    UnknownSessionError,
    VersionMismatchError,
)

STATUS: dict[type[SemtopoError], int] = {
    UnknownSessionError: 404,
    UnknownStepError: 404,
    UnknownZoneError: 404,
    UnknownPassageError: 404,
    UnknownRestrictionError: 404,
    UnauthorizedError: 401,
    UnknownKeyError: 404,
    AmbiguousZoneError: 409,
    AmbiguousQuestionError: 409,
    UnknownPositionError: 409,
    UnknownBorderError: 409,
    NoRouteError: 409,
    NotExportableError: 409,
    OutsideError: 409,
    TooNarrowError: 409,
    NotConnectedError: 409,
    UnprovedPathError: 500,
    NameTakenError: 409,
    NotesFullError: 409,
    NoWorldError: 409,
    MapFullError: 409,
    SequenceGapError: 409,
    SequenceReusedError: 422,
    KeyReusedError: 422,
    VersionMismatchError: 412,
    InvalidInputError: 422,
    InvalidMapError: 500,
    InvalidDatabaseError: 500,
    BusyError: 503,
    PictureError: 503,
    StorageError: 503,
}
"""The status of each error; a class that is not listed has that of its nearest listed base."""

ERRORS_MAX = 10
"""How many mistakes of one request are named."""

_METHOD_NOT_ALLOWED = 405

_RETRY_AFTER = {"Retry-After": "1"}

_HEADERS = {401: {"WWW-Authenticate": "Bearer"}, 503: _RETRY_AFTER}

_DOCUMENT_CODES = {
    "world": "invalid_world",
    "sensor": "invalid_sensor",
    "mapping": "invalid_option",
    "pose": "invalid_pose",
    "scan": "invalid_scan",
    "text": "invalid_question",
}
"""The code of a mistake in the shape of a request, by the part of the body that it is in."""

_PLAIN_CODES = {
    400: "malformed_request",
    404: "not_found",
    405: "method_not_allowed",
    413: "body_too_large",
    415: "unsupported_media_type",
}


class Problem(Response):
    """An error as `application/problem+json`."""

    media_type = "application/problem+json"

    def __init__(
        self, status: int, code: str, detail: str, headers: dict[str, str] | None = None,
        **more: Any,  # noqa: ANN401 -- RFC 9457 lets a problem have members of any kind
    ) -> None:  # fmt: skip
        """Write the problem; `more` are its further members."""
        body = {"type": f"urn:semtopo:{code}", "title": code.replace("_", " ").capitalize()}
        content = orjson.dumps({**body, "status": status, "code": code, "detail": detail, **more})
        super().__init__(content, status, headers)


def status_of(error: type[SemtopoError]) -> int:
    """Return the status of an error class, by its nearest base that has one."""
    return next(STATUS[base] for base in error.__mro__ if base in STATUS)


def register(app: FastAPI) -> None:
    """Let an application answer every error as a problem."""
    app.add_exception_handler(SemtopoError, _domain_problem)
    app.add_exception_handler(RequestValidationError, _request_problem)
    app.add_exception_handler(HTTPException, _plain_problem)
    app.add_exception_handler(DBAPIError, _storage_problem)
    app.add_exception_handler(PoolTimeoutError, _storage_problem)
    app.add_exception_handler(Exception, _unforeseen_problem)


async def _domain_problem(_request: Request, error: Exception) -> Problem:
    assert isinstance(error, SemtopoError)  # noqa: S101 -- registered for nothing else
    return problem_of(error)


def problem_of(error: SemtopoError) -> Problem:
    """Return an error as a problem."""
    status = status_of(type(error))
    headers = _HEADERS.get(status)
    return Problem(status, error.code, str(error), headers, **error.facts)


async def _request_problem(_request: Request, error: Exception) -> Problem:
    assert isinstance(error, RequestValidationError)  # noqa: S101 -- registered for nothing else
    found = error.errors()[:ERRORS_MAX]
    if found[0]["type"] == "json_invalid":
        return Problem(400, "malformed_json", "the body is not JSON")
    mistakes = [
        {"at": _place(one), "what": one["msg"].removeprefix("Value error, ")[:200]} for one in found
    ]
    place = next((part for part in found[0]["loc"][1:] if part in _DOCUMENT_CODES), None)
    code = _DOCUMENT_CODES.get(str(place), InvalidRequestError.code)
    where = ".".join(mistakes[0]["at"])
    return Problem(422, code, f"{where}: {mistakes[0]['what']}", errors=mistakes)


def _place(mistake: dict[str, Any]) -> list[str]:
    """Return where a mistake is: our own names and numbers, and `?` for a name that came in."""
    parts = [str(part) for part in mistake["loc"][:8]]
    if mistake["type"] == "extra_forbidden":
        parts[-1] = "?"
    if "kinds" in parts[:-1]:
        parts[parts.index("kinds") + 1] = "?"
    return parts


async def _plain_problem(request: Request, error: Exception) -> Problem:
    assert isinstance(error, HTTPException)  # noqa: S101 -- registered for nothing else
    code = _PLAIN_CODES.get(error.status_code, "refused")
    headers = dict(error.headers) if error.headers else {}
    if error.status_code == _METHOD_NOT_ALLOWED:
        headers["Allow"] = ", ".join(_methods(request))
    return Problem(error.status_code, code, code.replace("_", " "), headers)


def _methods(request: Request) -> list[str]:
    """Return every method that the path of a request has; Starlette names those of one route."""
    return [
        method
        for method in ("DELETE", "GET", "HEAD", "PATCH", "POST", "PUT")
        for route in request.app.router.routes
        if route.matches({**request.scope, "method": method})[0] is Match.FULL
    ]


async def _storage_problem(_request: Request, _error: Exception) -> Problem:
    detail = "the database does not answer; the same request may be sent again"
    return Problem(503, StorageError.code, detail, _RETRY_AFTER)


async def _unforeseen_problem(_request: Request, _error: Exception) -> Problem:
    return Problem(500, "internal_error", "this is a fault of the server; it has been logged")
