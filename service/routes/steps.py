"""Take steps, and read the log."""

from __future__ import annotations

import hashlib
from typing import Any

import orjson
from fastapi import APIRouter, Request, Response

from service.arguments import DirectRoute
from service.parameters import (
    AfterStep,
    IdempotencyKey,
    IfMatch,
    Limit,
    SessionId,
    entity_tags,
    idempotency_key,
    steps_of,
)
from service.recording import StepRequest
from service.replies import JsonBytes
from service.schemas.problems import problems
from service.schemas.steps import StepAnswer, StepDocument, StepsAnswer
from service.store import LoggedStep

router = APIRouter(
    tags=["mapping"], responses=problems(401, 413, 422, 503), route_class=DirectRoute
)


@router.post(
    "/sessions/{session_id}/step",
    status_code=201,
    response_model=StepAnswer,
    responses=problems(400, 404, 409, 412, 415),
)
async def take_step(
    request: Request,
    session_id: SessionId,
    document: StepDocument,
    key: IdempotencyKey = None,
    if_match: IfMatch = None,
) -> Response:
    """Take a step. It is on disk before the answer leaves; a retry gets the first answer again."""
    asked = step_request(document, idempotency_key(key), entity_tags(if_match))
    body = await steps_of(request).take(session_id, asked)
    headers = {"ETag": body.tag}
    if body.replayed:
        headers["Idempotency-Replayed"] = "true"
    return JsonBytes(body.content, 201, headers)


@router.get(
    "/sessions/{session_id}/steps",
    response_model=StepsAnswer,
    responses=problems(404),
)
async def list_steps(
    request: Request, session_id: SessionId, after: AfterStep = 0, limit: Limit = 100
) -> Response:
    """Read the log: every step with its input and its answer, in order."""
    page, more = await steps_of(request).page(session_id, after, limit)
    following = page[-1].seq if more else None
    return JsonBytes(orjson.dumps({"steps": [_step(one) for one in page], "next": following}))


def step_request(
    document: StepDocument, key: str | None = None, tags: frozenset[str] | None = None
) -> StepRequest:
    """Return a step that can be taken; raises InvalidScanError for an impossible scan."""
    given = document.model_dump_json(include={"pose", "scan"}, exclude_none=True)
    return StepRequest(
        pose=document.pose.value(),
        seen=None if document.scan is None else document.scan.value(),
        input=given,
        fingerprint=hashlib.sha256(given.encode()).digest(),
        seq=document.seq,
        key=key,
        if_match=tags,
    )


def _step(logged: LoggedStep) -> dict[str, Any]:
    return {
        "seq": logged.seq,
        "taken_at": logged.taken_at,
        "input": orjson.Fragment(logged.input),
        "answer": orjson.Fragment(logged.answer),
    }
