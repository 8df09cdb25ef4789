"""Take steps, each session's in order, and have them on disk before they are answered.

A step goes one way: it waits its turn in its session, is computed in a thread, recorded by the
writer, and only when that has committed does the new map become visible and the answer leave.
"""

from __future__ import annotations

import asyncio
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from time import thread_time

from semtopo import SemtopoError
from semtopo.codec import step_document, to_json
from service import store
from service.clock import now
from service.errors import BusyError, StorageError
from service.feeds import Feeds
from service.hot import HotSession, entity_tag
from service.metrics import Metrics
from service.recording import Computed, Recorded, Replayed, StepRequest, record
from service.sessions import Sessions
from service.settings import Settings
from service.stopwatch import Stopwatch

ATTEMPTS = 20
"""How often a step is computed anew because another process was faster."""

COMPUTERS = 4
"""Threads that compute long steps. They are no others' threads, so that readers never wait for
them; more would only share the same processors."""

SHORT_STEP_MS = 4.0
"""A step that takes no longer is not worth a thread: going there and back costs some 0.2 ms, and a
thread that computes keeps the others waiting for up to 5 ms at a time, as the event loop does."""

SHORT_INPUT = 2**13
"""Characters; a longer input may take much longer than the step before it."""


_OUTCOMES: dict[type[SemtopoError], str] = {BusyError: "busy", StorageError: "failed"}
"""How steps end that were not refused for a reason of their own, in a word for the metrics."""


@dataclass(frozen=True, slots=True)
class Answer:
    """The bytes of an answer, and the entity tag of the map after the step."""

    content: bytes
    tag: str
    replayed: bool = False


class Steps:
    """The steps of all sessions, taken by one process. For one event loop only."""

    def __init__(
        self, sessions: Sessions, feeds: Feeds, settings: Settings, metrics: Metrics
    ) -> None:
        """Begin with no step under way."""
        self._sessions = sessions
        self._feeds = feeds
        self._metrics = metrics
        self._running = 0
        self._ended = asyncio.Event()
        self._steps_max = settings.queue_max
        self._computers = ThreadPoolExecutor(COMPUTERS, thread_name_prefix="step")
        metrics.show("waiting_steps", "Steps that have not ended", lambda: self._running)

    async def take(self, session_id: str, request: StepRequest) -> Answer:
        """Take a step, and return its answer once it is on disk.

        Whoever is cancelled while it is being stored leaves it to its end. Raises BusyError where
        too many steps have begun already.
        """
        outcome = "failed"
        self._running += 1
        try:
            answer = await self._in_turn(session_id, request)
            outcome = "replayed" if answer.replayed else "recorded"
        except SemtopoError as error:
            outcome = _OUTCOMES.get(type(error), "refused")
            raise
        finally:
            self._running -= 1
            self._ended.set()
            self._metrics.count_step(outcome)
        return answer

    async def page(
        self, session_id: str, after: int, limit: int
    ) -> tuple[list[store.LoggedStep], bool]:
        """Return a page of the log, as `store.page_of_steps` does."""
        hot = await self._sessions.find(session_id)
        query = partial(store.page_of_steps, session=hot.row.number, after=after, limit=limit)
        return await self._sessions.read(query)

    async def close(self) -> None:
        """Let every step that has begun come to its end."""
        while self._running:
            self._ended.clear()
            await self._ended.wait()
        self._computers.shutdown()

    async def _in_turn(self, session_id: str, request: StepRequest) -> Answer:
        if self._running > self._steps_max:
            raise BusyError("too many steps are waiting")
        async with self._sessions.turn(session_id):
            hot = self._sessions.known(session_id) or await self._sessions.find(session_id)
            for _ in range(ATTEMPTS):
                done = await self._attempt(hot, request)
                if done is not None:
                    return done
                hot = await self._sessions.find(session_id)
        raise BusyError("other processes take steps in this session too fast")

    async def _attempt(self, hot: HotSession, request: StepRequest) -> Answer | None:
        """Compute and record a step on a map; return `None` if the map is stale."""
        computed = await self._compute(hot, request)
        change = partial(record, request=request, hot=hot, computed=computed)
        try:
            outcome = await self._sessions.commit(change)
        except StorageError:
            self._sessions.forget(hot.row.id)  # whether it was stored is not known
            raise
        match outcome:
            case Recorded() if computed is not None:
                after = hot.after(computed.step.state, computed.cpu_ms)
                self._sessions.keep(after)
                self._feeds.tell(hot.row.number)
                # when the answer has left
                loop = asyncio.get_running_loop()
                loop.call_soon(self._metrics.time_stages, computed.timings_ms)
                return Answer(computed.answer.encode(), after.tag)
            case Replayed(seq, content):
                return Answer(content.encode(), entity_tag(hot.row.number, seq), replayed=True)
            case SemtopoError():
                raise outcome
            case _:
                return None

    async def _compute(self, hot: HotSession, request: StepRequest) -> Computed | None:
        """Compute a step, unless it must have been taken before; a long one in a thread."""
        if request.seq is not None and request.seq <= hot.seq:
            return None
        is_short = hot.step_ms <= SHORT_STEP_MS and len(request.input) <= SHORT_INPUT
        if is_short and hot.is_light:
            return _computed(hot, request)
        loop = asyncio.get_running_loop()
        return await loop.run_in_executor(self._computers, _computed, hot, request)


def _computed(hot: HotSession, request: StepRequest) -> Computed:
    begun, watch = thread_time(), Stopwatch()
    taken = hot.take(request.pose, request.seen, watch)
    timings = watch.timings_ms()
    document = {**step_document(taken), "timings_ms": timings}
    cpu_ms = 1000 * (thread_time() - begun)
    return Computed(taken, to_json(document).decode(), now(), timings, cpu_ms)
