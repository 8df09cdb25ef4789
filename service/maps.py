"""Show maps, as they are and as they were, and answer questions about them."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from functools import partial

from semtopo import (
    Answer,
    Atlas,
    MapState,
    Place,
    Route,
    RouteRequest,
    UnknownStepError,
    answer,
    find_routes,
    resolve,
    resolve_one,
)
from semtopo.codec import graph_body
from semtopo.exports.sight import sight_body
from service.history import scan_at, state_at
from service.hot import HotSession, entity_tag
from service.recent import Recent
from service.sessions import Sessions
from service.settings import Settings


@dataclass(frozen=True, slots=True)
class Body:
    """The bytes of an answer, and the entity tag of the map that they show."""

    content: bytes
    tag: str


class Maps:
    """The maps of all sessions, for those who read them."""

    def __init__(self, sessions: Sessions, settings: Settings) -> None:
        """Begin without bodies in memory."""
        self._sessions = sessions
        self._bodies: Recent[tuple[str, str], Body] = Recent(
            settings.cached_bodies_max, settings.cached_bytes_max, lambda body: len(body.content)
        )

    async def view(
        self, session_id: str, at: int | None, kind: str, build: Callable[[MapState], bytes]
    ) -> Body:
        """Return what `build` makes of a map, now or as of step `at`; kept in memory by `kind`."""
        return await self.body(
            session_id, at, kind, lambda _, state: asyncio.to_thread(build, state)
        )

    async def body(
        self,
        session_id: str,
        at: int | None,
        kind: str,
        build: Callable[[HotSession, MapState], Awaitable[bytes]],
    ) -> Body:
        """Return what `build` makes of a session and its map; kept in memory by `kind`."""
        hot = await self._sessions.find(session_id)
        tag = entity_tag(hot.row.number, _checked(at, hot))
        body = self._bodies.get((tag, kind))
        if body is None:
            body = Body(await build(hot, await self.state(hot, at)), tag)
            self._bodies.put((tag, kind), body)
        return body

    async def graph(self, session_id: str, at: int | None) -> Body:
        """Return the graph of a map: now, or as of step `at`."""
        hot = await self._sessions.find(session_id)
        seq = _checked(at, hot)
        # passages are never moved nor removed, so an earlier graph is a part of this one
        content = await asyncio.to_thread(lambda: graph_body(hot.state.graph.at(seq), seq))
        return Body(content, entity_tag(hot.row.number, seq))

    async def sight(self, session_id: str, at: int | None) -> Body:
        """Return what the robot saw at the last step, or at step `at`."""
        hot = await self._sessions.find(session_id)
        seq = _checked(at, hot)
        seen = await self._sessions.read(partial(scan_at, hot=hot, seq=seq))
        return Body(sight_body(seq, seen), entity_tag(hot.row.number, seq))

    async def route(self, session_id: str, source: str, target: str) -> Route:
        """Return the route between two zones, by their names."""
        return await self.route_of((await self._sessions.find(session_id)).state, source, target)

    async def route_of(self, state: MapState, source: str, target: str) -> Route:
        """Return the route between two zones of a map, by their names."""
        atlas = Atlas(state)
        request = RouteRequest(
            start=Place(resolve_one(atlas, source)),
            goals=tuple(map(Place, resolve(atlas, target))),
        )
        return (await asyncio.to_thread(find_routes, atlas, request))[0]

    async def answer(self, session_id: str, text: str) -> Answer:
        """Return the answer to a sentence; in the thread that it takes, it may read older maps."""
        hot = await self._sessions.find(session_id)

        def history(seq: int) -> MapState:
            return self._sessions.read_here(partial(state_at, hot=hot, seq=seq))

        return await asyncio.to_thread(answer, Atlas(hot.state), text, history)

    async def state(self, hot: HotSession, at: int | None) -> MapState:
        """Return the map of a session: now, or as of step `at`; raises UnknownStepError."""
        seq = _checked(at, hot)
        if seq == hot.seq:
            return hot.state
        return await self._sessions.read(partial(state_at, hot=hot, seq=seq))


def _checked(at: int | None, hot: HotSession) -> int:
    """Return the step that is asked for; raises UnknownStepError if it was not taken yet."""
    if at is None:
        return hot.seq
    if at > hot.seq:
        raise UnknownStepError(f"the last step of this session is {hot.seq}")
    return at
