"""Give earlier maps: from the nearest one that is at hand, the log is replayed."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from threading import Lock
from typing import TypeAlias
from weakref import WeakValueDictionary

from sqlalchemy import Connection

from semtopo import MapState, step
from service import store
from service.errors import UnknownSessionError
from service.history import look_again
from service.hot import HotSession, bytes_of
from service.recent import Recent
from service.settings import Settings

KEPT_EVERY = 8
"""Steps between maps that a replay leaves in memory: those beside it are then some ms away."""

Read: TypeAlias = Callable[[Callable[[Connection], MapState]], MapState]
"""Runs a query in the thread that asks, in a transaction that sees one state."""


class Past:
    """Earlier maps of all sessions, a few of them in memory. For any thread."""

    def __init__(self, read: Read, settings: Settings) -> None:
        """Begin with nothing in memory."""
        self._read = read
        self._kept: Recent[tuple[int, int], MapState] = Recent(
            settings.past_maps_max, settings.past_bytes_max, bytes_of
        )
        self._guard = Lock()
        self._turns: WeakValueDictionary[int, Lock] = WeakValueDictionary()

    def state_at(self, hot: HotSession, seq: int) -> MapState:
        """Return the map of a session as of step `seq`, which it has taken; 0 is the empty map.

        Raises
        ------
        UnknownSessionError
            The session was deleted meanwhile.
        """
        with self._turn(hot):  # whoever wants the same map waits for it, and then has it
            known = self._nearest(hot, seq)
            if known is not None and known.seq == seq:
                return known
            return self._read(partial(self._replayed, hot=hot, seq=seq, known=known))

    def _replayed(
        self, connection: Connection, hot: HotSession, seq: int, known: MapState | None
    ) -> MapState:
        """Return an earlier map, from a known one or else from the checkpoint before it."""
        if store.find_version(connection, hot.row.id) is None:
            raise UnknownSessionError("there is no session of that id")
        state = store.load_checkpoint(connection, hot.row, seq) if known is None else known
        for logged in store.list_steps(connection, hot.row.number, state.seq, seq - state.seq):
            _, scan = look_again(hot, logged)
            state = step(state, scan, hot.options).state
            if state.seq % KEPT_EVERY == 0:
                self._keep(hot, state)
        self._keep(hot, state)
        return state

    def _nearest(self, hot: HotSession, seq: int) -> MapState | None:
        """Return the last map in memory from the checkpoint before a step on, if there is one."""
        checkpoint = seq - seq % hot.row.checkpoint_every
        with self._guard:
            for at in range(seq, checkpoint - 1, -1):
                state = self._kept.get((hot.row.number, at))
                if state is not None:
                    return state
        return None

    def _keep(self, hot: HotSession, state: MapState) -> None:
        with self._guard:
            self._kept.put((hot.row.number, state.seq), state)

    def _turn(self, hot: HotSession) -> Lock:
        """Return the lock of a session's earlier maps."""
        with self._guard:
            return self._turns.setdefault(hot.row.number, Lock())
