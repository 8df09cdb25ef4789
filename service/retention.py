"""Delete sessions that nobody has used for long, if the settings say so."""

from __future__ import annotations

import asyncio
import logging
from datetime import UTC, datetime, timedelta
from functools import partial

from semtopo.errors import SemtopoError
from service import store
from service.clock import written
from service.sessions import Sessions

_log = logging.getLogger(__name__)

AT_ONCE = 20
"""Sessions that are looked for at once; each is deleted in a transaction of its own."""

LOOKS = 24
"""How often a session's time to live is divided into looks, so that none stays much longer."""

LOOK_SECONDS_MAX = 3_600.0


async def keep_for(days: float, sessions: Sessions) -> None:
    """Delete, for ever, sessions that began, and took no step, for so many days."""
    span = timedelta(days=days)
    pause = min(LOOK_SECONDS_MAX, span.total_seconds() / LOOKS)
    while True:
        await asyncio.sleep(pause)
        try:
            count = await delete_unused(written(datetime.now(UTC) - span), sessions)
        except SemtopoError:
            _log.exception("sessions that nobody uses could not be deleted")
        else:
            if count:
                _log.info("deleted %d sessions that nobody used for %g days", count, days)


async def delete_unused(before: str, sessions: Sessions) -> int:
    """Delete sessions not used since a time, a few at a time; return how many there were."""
    count = 0
    while unused := await sessions.read(partial(store.list_unused, before=before, limit=AT_ONCE)):
        deleted = [await sessions.delete_unused(session_id, before) for session_id in unused]
        count += sum(deleted)
        if not any(deleted):
            break
    return count
