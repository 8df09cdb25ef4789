"""Ask in words."""

from __future__ import annotations

import orjson
from fastapi import APIRouter, Request, Response

from semtopo.codec import answer_document
from semtopo.journey import WayOptions
from service.arguments import DirectRoute
from service.parameters import SessionId, maps_of
from service.replies import JsonBytes
from service.schemas.problems import problems
from service.schemas.questions import QueryAnswer, QueryRequest

router = APIRouter(
    tags=["answers"], responses=problems(401, 413, 422, 503), route_class=DirectRoute
)


@router.post(
    "/sessions/{session_id}/query",
    response_model=QueryAnswer,
    responses=problems(400, 404, 409, 415),
)
async def ask(request: Request, session_id: SessionId, question: QueryRequest) -> Response:
    """Answer a question in words, such as "path from corridor to C"."""
    options = WayOptions(question.radius, question.two_way)
    answer = await maps_of(request).answer(session_id, question.text, options)
    return JsonBytes(orjson.dumps(answer_document(answer)))
