"""Show maps, as they are and as they were, and answer questions about them."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable
from dataclasses import dataclass, replace
from functools import partial

from semtopo import (
    Answer,
    Atlas,
    MapState,
    UnknownStepError,
    answer,
)
from semtopo.codec import graph_body
from semtopo.exports.sight import sight_body
from semtopo.journey import WayOptions
from service.clock import seconds
from service.history import notes_at, scan_at
from service.hot import HotSession, entity_tag
from service.notes import Notes
from service.past import Past
from service.recent import Recent
from service.sessions import Sessions
from service.settings import Settings


@dataclass(frozen=True, slots=True)
class Body:
    """The bytes of an answer, and the entity tag of the map that they show."""

    content: bytes
    tag: str


@dataclass(frozen=True, slots=True, eq=False)
class Moment:
    """A session as of step `seq`, with its notes, and the time `now` in s since the epoch."""

    hot: HotSession
    seq: int
    notes: Notes
    now: float

    @property
    def tag(self) -> str:
        """The entity tag of all that is shown of this moment (RFC 9110, 8.8.3)."""
        return entity_tag(self.hot.row.number, self.seq, self.notes.version(self.now))

    def atlas(self, state: MapState) -> Atlas:
        """Return the map with its notes."""
        return self.notes.atlas(state, self.now)

    def graph_body(self, since: int | None = None) -> bytes:
        """Return the graph with its notes, or what a step after `since` changed of it.

        The graph of today knows what it was at earlier steps.
        """
        graph = self.hot.state.graph.at(self.seq)
        atlas = self.atlas(replace(self.hot.state, seq=self.seq, graph=graph))
        return graph_body(graph, self.seq, atlas.notes, atlas.limits, taken(since, self.seq))


def taken(since: int | None, seq: int) -> int | None:
    """Return the step after which changes are asked for; raises UnknownStepError if after `seq`."""
    if since is not None and since > seq:
        raise UnknownStepError(f"there is no step {since} here, the last is {seq}")
    return since


class Maps:
    """The maps of all sessions, for those who read them."""

    def __init__(self, sessions: Sessions, settings: Settings) -> None:
        """Begin without bodies in memory."""
        self._sessions = sessions
        self._past = Past(sessions.read_here, settings)
        self._bodies: Recent[tuple[str, str], Body] = Recent(
            settings.cached_bodies_max, settings.cached_bytes_max, lambda body: len(body.content)
        )

    async def view(
        self, session_id: str, at: int | None, kind: str, build: Callable[[Atlas], bytes]
    ) -> Body:
        """Return what `build` makes of a map, now or as of step `at`; kept in memory by `kind`."""
        return await self.body(
            session_id, at, kind,
            lambda moment, state: asyncio.to_thread(build, moment.atlas(state)),
        )  # fmt: skip

    async def body(
        self,
        session_id: str,
        at: int | None,
        kind: str,
        build: Callable[[Moment, MapState], Awaitable[bytes]],
    ) -> Body:
        """Return what `build` makes of a session and its map; kept in memory by `kind`."""
        moment = await self.moment(session_id, at)
        body = self._bodies.get((moment.tag, kind))
        if body is None:
            body = Body(await build(moment, await self._state(moment)), moment.tag)
            self._bodies.put((moment.tag, kind), body)
        return body

    async def graph(self, session_id: str, at: int | None, since: int | None = None) -> Body:
        """Return the graph of a map, now or as of step `at`; or what changed after `since`."""
        moment = await self.moment(session_id, at)
        key = (moment.tag, f"graph {since}")
        body = self._bodies.get(key)
        if body is None:
            content = await asyncio.to_thread(moment.graph_body, since)
            body = Body(content, moment.tag)
            self._bodies.put(key, body)
        return body

    async def sight(self, session_id: str, at: int | None) -> Body:
        """Return what the robot saw at the last step, or at step `at`."""
        moment = await self.moment(session_id, at)
        seen = await self._sessions.read(partial(scan_at, hot=moment.hot, seq=moment.seq))
        return Body(sight_body(moment.seq, seen), moment.tag)

    async def atlas(self, session_id: str, at: int | None = None) -> Atlas:
        """Return the map of a session with its notes: now, or as of step `at`."""
        moment = await self.moment(session_id, at)
        return moment.atlas(await self._state(moment))

    async def answer(self, session_id: str, text: str, options: WayOptions) -> Answer:
        """Return the answer to a sentence; in the thread that it takes, it may read older maps."""
        moment = await self.moment(session_id, None)

        history = partial(self._past.state_at, moment.hot)
        atlas = moment.atlas(moment.hot.state)
        return await asyncio.to_thread(answer, atlas, text, history, options)

    async def moment(self, session_id: str, at: int | None) -> Moment:
        """Return a session as it is, or as of step `at`; raises UnknownStepError."""
        hot = await self._sessions.find(session_id)
        seq = hot.seq if at is None else at
        if seq > hot.seq:
            raise UnknownStepError(f"the last step of this session is {hot.seq}")
        if seq == hot.seq or not hot.notes.revision:
            return Moment(hot, seq, hot.notes, seconds())
        return Moment(hot, seq, *await self._sessions.read(partial(notes_at, hot=hot, seq=seq)))

    async def _state(self, moment: Moment) -> MapState:
        """Return the map at a moment."""
        if moment.seq == moment.hot.seq:
            return moment.hot.state
        return await asyncio.to_thread(self._past.state_at, moment.hot, moment.seq)
