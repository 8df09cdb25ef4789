"""What can be done with sessions: the service without its HTTP.

A step goes one way: it waits its turn in its session, is computed in a thread, recorded by the
writer, and only when that has committed does the new map become visible and the answer leave.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Coroutine
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import partial
from typing import Any, TypeVar
from weakref import WeakValueDictionary

from sqlalchemy import Connection

from semtopo import (
    MapState,
    PathAnswer,
    Route,
    SemtopoError,
    answer,
    find_route,
    find_zone,
)
from semtopo.codec import graph_body, step_document, to_json
from service import store
from service.database import Database
from service.errors import BusyError, StorageError, UnknownSessionError, UnknownStepError
from service.history import state_at
from service.hot import HotSession, Recent, entity_tag, load
from service.keys import authenticate
from service.metrics import Metrics
from service.recording import Computed, Recorded, Replayed, StepRequest, record
from service.settings import Settings
from service.stopwatch import Stopwatch
from service.writer import Writer

Result = TypeVar("Result")

ATTEMPTS = 20
"""How often a step is computed anew because another process was faster."""

SHORT_STEP_MS = 4.0
"""A step that takes no longer is not worth a thread: going there and back costs some 0.2 ms, and a
thread that computes keeps the others waiting for up to 5 ms at a time, as the event loop does."""

SHORT_INPUT = 2**13
"""Characters; a longer input may take much longer than the step before it."""


@dataclass(frozen=True, slots=True)
class Body:
    """The bytes of an answer, and the entity tag of the map that they show."""

    content: bytes
    tag: str
    replayed: bool = False


class Sessions:
    """All sessions of one database, as one process sees them. For one event loop only."""

    def __init__(
        self, database: Database, writer: Writer, settings: Settings, metrics: Metrics
    ) -> None:
        """Begin with nothing in memory."""
        self._database = database
        self._metrics = metrics
        self._writer = writer
        self._hot: Recent[str, HotSession] = Recent(
            settings.hot_sessions_max, settings.hot_bytes_max, lambda hot: hot.weight
        )
        self._bodies: Recent[tuple[str, str], Body] = Recent(
            settings.cached_bodies_max, settings.cached_bytes_max, lambda body: len(body.content)
        )
        self._turns: WeakValueDictionary[str, asyncio.Lock] = WeakValueDictionary()
        self._running: set[asyncio.Task[Any]] = set()
        self._steps_max = settings.queue_max
        metrics.show("hot_sessions", "Sessions in memory", lambda: len(self._hot))
        metrics.show("hot_bytes", "What they take, as estimated", lambda: self._hot.weight)
        metrics.show("waiting_steps", "Steps that have not ended", lambda: len(self._running))

    async def create(self, new: store.NewSession) -> HotSession:
        """Store a new session."""
        await self._writer.commit(partial(store.add_session, new=new))
        return await self.find(new.id)

    async def find(self, session_id: str) -> HotSession:
        """Return a session as it is stored; raises UnknownSessionError."""
        query = partial(load, session_id=session_id, known=self._hot.get(session_id))
        found = await self._read(query)
        newest = self._hot.get(session_id)
        if newest is None or newest.row.number != found.row.number or newest.seq < found.seq:
            self._hot.put(session_id, found)  # while this was read, a step may have gone further
        return found

    async def page(self, owner: int | None, after: int, limit: int) -> list[store.SessionHead]:
        """Return up to `limit` sessions of an owner, or of all, as `store.list_sessions` does."""
        query = partial(store.list_sessions, owner=owner, after=after, limit=limit)
        return await self._read(query)

    async def authenticate(self, key: str) -> int:
        """Return the number of an API key; raises UnauthorizedError."""
        return await self._read(partial(authenticate, key=key))

    async def delete(self, session_id: str) -> None:
        """Delete a session with all that belongs to it; raises UnknownSessionError."""
        async with self._turn(session_id):
            change = partial(store.delete_session, session_id=session_id)
            existed = await self._writer.commit(change)
            self._hot.drop(session_id)
        if not existed:
            raise UnknownSessionError("there is no session of that id")

    async def step(self, session_id: str, request: StepRequest) -> Body:
        """Take a step, and return its answer once it is on disk.

        It goes on to its end even if whoever asked for it goes away. Raises BusyError where too
        many steps have begun already.
        """
        if len(self._running) >= self._steps_max:
            self._metrics.count_step("busy")
            raise BusyError("too many steps are waiting")
        return await self._to_its_end(self._step_in_turn(session_id, request))

    async def view(
        self, session_id: str, at: int | None, kind: str, build: Callable[[MapState], bytes]
    ) -> Body:
        """Return what `build` makes of a map, now or as of step `at`; kept in memory by `kind`."""
        return await self._body(await self.find(session_id), at, kind, build)

    async def graph(self, session_id: str, at: int | None) -> Body:
        """Return the graph of a map: now, or as of step `at`."""
        hot = await self.find(session_id)
        seq = _checked(at, hot)
        # passages are never moved nor removed, so an earlier graph is a part of this one
        content = await asyncio.to_thread(lambda: graph_body(hot.state.graph.at(seq), seq))
        return Body(content, entity_tag(hot.row.number, seq))

    async def steps(
        self, session_id: str, after: int, limit: int
    ) -> tuple[list[store.LoggedStep], bool]:
        """Return a page of the log, as `store.page_of_steps` does."""
        hot = await self.find(session_id)
        query = partial(store.page_of_steps, session=hot.row.number, after=after, limit=limit)
        return await self._read(query)

    async def route(self, session_id: str, source: str, target: str) -> Route:
        """Return the route between two zones, by their names."""
        graph = (await self.find(session_id)).state.graph
        ends = (find_zone(graph.nodes, source), find_zone(graph.nodes, target))
        return await asyncio.to_thread(find_route, graph, *ends)

    async def answer(self, session_id: str, text: str) -> PathAnswer:
        """Return the answer to a sentence."""
        hot = await self.find(session_id)
        return await asyncio.to_thread(answer, hot.state, text)

    async def close(self) -> None:
        """Let every step that has begun come to its end."""
        while self._running:
            await asyncio.wait(self._running)

    async def _step_in_turn(self, session_id: str, request: StepRequest) -> Body:
        async with self._turn(session_id):
            hot = self._hot.get(session_id) or await self.find(session_id)
            for _ in range(ATTEMPTS):
                done = await self._attempt(hot, request)
                if done is not None:
                    return done
                hot = await self.find(session_id)
        raise BusyError("other processes take steps in this session too fast")

    async def _attempt(self, hot: HotSession, request: StepRequest) -> Body | None:
        """Compute and record a step on a map; return `None` if the map is stale."""
        computed = await self._compute(hot, request)
        change = partial(record, request=request, hot=hot, computed=computed)
        try:
            outcome = await self._writer.commit(change)
        except StorageError:
            self._hot.drop(hot.row.id)  # whether it was stored is not known
            raise
        match outcome:
            case Recorded() if computed is not None:
                after = hot.after(computed.step.state, computed.timings_ms["total"])
                self._metrics.time_stages(computed.timings_ms)
                self._hot.put(hot.row.id, after)
                return Body(computed.answer.encode(), after.tag)
            case Replayed(seq, content):
                return Body(content.encode(), entity_tag(hot.row.number, seq), replayed=True)
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
        return await asyncio.to_thread(_computed, hot, request)

    async def _body(
        self, hot: HotSession, at: int | None, kind: str, build: Callable[[MapState], bytes]
    ) -> Body:
        """Return a body from memory, else build it in a thread."""
        seq = _checked(at, hot)
        tag = entity_tag(hot.row.number, seq)
        body = self._bodies.get((tag, kind))
        if body is None:
            state = await self._state(hot, seq)
            body = Body(await asyncio.to_thread(build, state), tag)
            self._bodies.put((tag, kind), body)
        return body

    async def _state(self, hot: HotSession, seq: int) -> MapState:
        """Return the map of a session as of step `seq`."""
        if seq == hot.seq:
            return hot.state
        return await self._read(partial(state_at, hot=hot, seq=seq))

    async def _read(self, query: Callable[[Connection], Result]) -> Result:
        """Run a query in a thread, in a transaction that sees one state."""
        return await asyncio.to_thread(self._read_now, query)

    def _read_now(self, query: Callable[[Connection], Result]) -> Result:
        with self._database.reader.begin() as connection:
            return query(connection)

    async def _to_its_end(self, work: Coroutine[Any, Any, Body]) -> Body:
        """Run a step that goes on if the caller is cancelled."""
        task = asyncio.get_running_loop().create_task(work)
        self._running.add(task)
        task.add_done_callback(self._running.discard)
        task.add_done_callback(lambda task: self._metrics.count_step(_outcome(task)))
        return await asyncio.shield(task)

    def _turn(self, session_id: str) -> asyncio.Lock:
        """Return the lock that puts the steps of a session in order (first come, first served)."""
        lock = self._turns.get(session_id)
        if lock is None:
            lock = self._turns[session_id] = asyncio.Lock()
        return lock


def _outcome(step: asyncio.Task[Body]) -> str:
    """Say in a word how a step ended."""
    error = None if step.cancelled() else step.exception()
    match error:
        case None:
            return "replayed" if not step.cancelled() and step.result().replayed else "recorded"
        case BusyError():
            return "busy"
        case SemtopoError() if not isinstance(error, StorageError):
            return "refused"
        case _:
            return "failed"


def _computed(hot: HotSession, request: StepRequest) -> Computed:
    watch = Stopwatch()
    taken = hot.take(request.pose, request.seen, watch)
    timings = watch.timings_ms()
    document = {**step_document(taken), "timings_ms": timings}
    return Computed(hot, taken, to_json(document).decode(), now(), timings)


def now() -> str:
    """Return the time: ISO 8601, UTC, milliseconds."""
    return datetime.now(UTC).isoformat(timespec="milliseconds")


def _checked(at: int | None, hot: HotSession) -> int:
    """Return the step that is asked for; raises UnknownStepError if it was not taken yet."""
    if at is None:
        return hot.seq
    if at > hot.seq:
        raise UnknownStepError(f"the last step of this session is {hot.seq}")
    return at
