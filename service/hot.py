"""Keep the maps of busy sessions in memory, and nothing there that is not on disk.

A hot session is what a step needs: world, sensor, options and the map itself. It is checked against
the stored version before it is believed, and replaced only after a commit.
"""

from __future__ import annotations

import math
from collections import OrderedDict
from dataclasses import dataclass, replace
from typing import Generic, TypeVar

from sqlalchemy import Connection

from semtopo import (
    LabelledRuns,
    MappingDocument,
    MappingOptions,
    MapState,
    Pose,
    Sensor,
    SensorDocument,
    Stage,
    Step,
    World,
    WorldDocument,
    from_runs,
    scan_world,
    step,
)
from service import store
from service.errors import NoWorldError, UnknownSessionError
from service.stopwatch import Stopwatch

Key = TypeVar("Key")
Value = TypeVar("Value")


@dataclass(frozen=True, slots=True, eq=False)
class HotSession:
    """A session in memory, as of step `state.seq`."""

    row: store.SessionRow
    world: World | None
    sensor: Sensor
    options: MappingOptions
    state: MapState
    step_ms: float = math.inf
    """How long the last step took to compute; unknown before the first."""

    @property
    def tag(self) -> str:
        """The entity tag of the map as it is (RFC 9110, 8.8.3)."""
        return entity_tag(self.row.number, self.state.seq)

    def after(self, state: MapState, step_ms: float) -> HotSession:
        """Return the session with the map after one more step, which took `step_ms`."""
        row = replace(self.row, version=state.seq)
        return replace(self, row=row, state=state, step_ms=step_ms)

    def take(self, pose: Pose, seen: LabelledRuns | None, watch: Stopwatch) -> Step:
        """Take one step: with what a real sensor saw, else with the simulated one.

        Raises
        ------
        NoWorldError
            There is neither a scan nor a world.
        """
        if seen is not None:
            scan = from_runs(pose, seen)
            watch.ended(Stage.ANALYSIS)
        elif self.world is not None:
            scan = scan_world(self.world, self.sensor, pose.position, watch.ended)
        else:
            raise NoWorldError("this session has no world to sense, so a step needs a scan")
        return step(self.state, scan, self.options, watch.ended)


def entity_tag(session: int, seq: int) -> str:
    """Return the entity tag of a session's map as of step `seq`."""
    return f'"{session}-{seq}"'


def load(connection: Connection, session_id: str, known: HotSession | None) -> HotSession:
    """Return a session as it is stored; `known` itself, if it is up to date.

    Raises
    ------
    UnknownSessionError
        There is no session of that id.
    """
    version = (known.row.number, known.state.seq) if known else None
    if known is not None and store.find_version(connection, session_id) == version:
        return known
    row = store.find_session(connection, session_id)
    if row is None:
        raise UnknownSessionError("there is no session of that id")
    world = None if row.world is None else WorldDocument.model_validate_json(row.world).value()
    sensor = SensorDocument.model_validate_json(row.sensor).value()
    options = MappingDocument.model_validate_json(row.mapping).value()
    return HotSession(row, world, sensor, options, store.load_state(connection, row))


class Recent(Generic[Key, Value]):
    """A dictionary that forgets what was not used for longest. For one thread only."""

    def __init__(self, size: int) -> None:
        """Make room for `size` entries."""
        self._size = size
        self._entries: OrderedDict[Key, Value] = OrderedDict()

    def __len__(self) -> int:
        """Return the number of entries."""
        return len(self._entries)

    def get(self, key: Key) -> Value | None:
        """Return an entry, which thereby becomes the most recent one."""
        if key not in self._entries:
            return None
        self._entries.move_to_end(key)
        return self._entries[key]

    def put(self, key: Key, value: Value) -> None:
        """Keep an entry, and forget the oldest one if there are too many."""
        self._entries[key] = value
        self._entries.move_to_end(key)
        if len(self._entries) > self._size:
            self._entries.popitem(last=False)

    def drop(self, key: Key) -> None:
        """Forget an entry, if it is there."""
        self._entries.pop(key, None)
