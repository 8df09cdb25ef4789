"""The HTTP interface: every endpoint parses, calls one function of the service, and answers."""

from __future__ import annotations

from fastapi.routing import APIRoute

from service.routes import (
    answers,
    exports,
    live,
    maps,
    notes,
    operations,
    pictures,
    questions,
    sessions,
    steps,
    views,
)

ROOMS = (
    steps, maps, sessions, live, notes, views, pictures, exports, answers, questions, operations,
)  # fmt: skip

ROUTES: list[APIRoute] = [route for room in ROOMS for route in room.router.routes]
"""All routes, in the order in which they are tried: first those that are asked for most often."""
