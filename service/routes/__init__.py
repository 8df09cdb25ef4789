"""The HTTP interface: every endpoint parses, calls one function of the service, and answers."""

from __future__ import annotations

from fastapi import APIRouter

from service.routes import (
    answers,
    live,
    maps,
    operations,
    pictures,
    questions,
    sessions,
    steps,
    views,
)

router = APIRouter()
for room in (sessions, steps, live, maps, views, pictures, answers, questions, operations):
    router.include_router(room.router)
