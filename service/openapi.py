"""Describe the interface as it is: FastAPI alone would declare errors as plain JSON.

Routes name the statuses of the errors that they may answer; here they get their media type, and
headers that belong to them.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from fastapi import FastAPI

_PROBLEM = {"application/problem+json": {"schema": {"$ref": "#/components/schemas/ProblemAnswer"}}}
_RETRY_AFTER = {"Retry-After": {"description": "seconds", "schema": {"type": "string"}}}
_CLIENT_ERROR = 400
_METHODS = ("delete", "get", "post", "put")


class DescribedApi(FastAPI):
    """An application that describes its errors as problems, and its keys if it asks for any."""

    def openapi(self) -> dict[str, Any]:
        """Return the OpenAPI document."""
        described = super().openapi()  # made once, and kept
        for operation in _operations(described):
            for status, response in operation["responses"].items():
                if int(status) >= _CLIENT_ERROR:
                    response["content"] = _PROBLEM
                if status == "503":
                    response["headers"] = _RETRY_AFTER
        if self.state.settings.keys:
            schemes = {"key": {"type": "http", "scheme": "bearer"}}
            described["components"]["securitySchemes"] = schemes
            described["security"] = [{"key": []}]
        return described


def _operations(described: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """Yield the operations of all paths."""
    for path in described["paths"].values():
        yield from (path[method] for method in _METHODS if method in path)
