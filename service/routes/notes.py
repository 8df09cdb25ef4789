"""Note what people call zones, and what is closed or costly."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import Annotated, Any

import orjson
from fastapi import APIRouter, Path, Request, Response

from semtopo import Restriction, ZoneNotes
from semtopo.documents import LABEL_LENGTH_MAX
from service.changes import in_force
from service.notes import on_document
from service.parameters import AtStep, SessionId, changes_of, maps_of
from service.replies import JsonBytes
from service.schemas.notes import (
    RestrictionAnswer,
    RestrictionRequest,
    RestrictionsAnswer,
    ZoneNotesAnswer,
    ZoneNotesRequest,
)
from service.schemas.problems import problems

router = APIRouter(
    prefix="/sessions/{session_id}", tags=["notes"], responses=problems(401, 404, 413, 422, 503)
)


@router.put(
    "/zones/{zone_id:path}", response_model=ZoneNotesAnswer, responses=problems(400, 409, 415)
)
async def note_zone(
    request: Request,
    session_id: SessionId,
    zone_id: Annotated[str, Path(min_length=1, max_length=2 * LABEL_LENGTH_MAX)],
    document: ZoneNotesRequest,
) -> Response:
    """Note other names of a zone, and its class, in place of what was noted before."""
    notes = ZoneNotes(tuple(dict.fromkeys(document.aliases)), document.zone_class)
    hot = await changes_of(request).note(session_id, zone_id, notes)
    label = hot.state.graph.nodes[zone_id].label
    answer = {
        "id": zone_id, "label": label, "aliases": notes.aliases, "class": notes.zone_class,
    }  # fmt: skip
    return JsonBytes(orjson.dumps(answer))


@router.get("/restrictions", response_model=RestrictionsAnswer)
async def list_restrictions(request: Request, session_id: SessionId, at: AtStep = None) -> Response:
    """List the restrictions that hold, now or as of a step."""
    atlas = await maps_of(request).atlas(session_id, at)
    listed = [_document(it) for it in in_force(atlas)]
    return JsonBytes(orjson.dumps({"seq": atlas.state.seq, "restrictions": listed}))


@router.post(
    "/restrictions",
    status_code=201,
    response_model=RestrictionAnswer,
    responses={
        200: {"model": RestrictionAnswer, "description": "in place of the one before"},
        **problems(400, 409, 415),
    },
)
async def restrict(
    request: Request, session_id: SessionId, document: RestrictionRequest
) -> Response:
    """Close something, or let it cost more or less. Sent again, it is the same restriction."""
    made, is_new = await changes_of(request).restrict(session_id, document.value())
    return JsonBytes(orjson.dumps(_document(made)), 201 if is_new else 200)


@router.delete("/restrictions/{restriction_id}", status_code=204)
async def lift(
    request: Request,
    session_id: SessionId,
    restriction_id: Annotated[str, Path(pattern=r"^[0-9a-f]{1,64}$")],
) -> Response:
    """Lift a restriction."""
    await changes_of(request).lift(session_id, restriction_id)
    return Response(status_code=204)


def _document(one: Restriction) -> dict[str, Any]:
    ends = None if one.expires_at is None else datetime.fromtimestamp(one.expires_at, UTC)
    return {
        "id": one.id,
        **on_document(one.on),
        "closed": one.closed,
        "factor": one.factor,
        "expires_at": None if ends is None else ends.isoformat(timespec="milliseconds"),
        "since": one.since,
        **({} if one.was is None else {"was": on_document(one.was)}),
    }
