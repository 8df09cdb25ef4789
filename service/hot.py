"""Keep the maps of busy sessions in memory, and nothing there that is not on disk.

A hot session is what a step needs: world, sensor, options and the map itself. It is checked against
the stored version before it is believed, and replaced only after a commit.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field, replace

from sqlalchemy import Connection

from semtopo import (
    Doorway,
    LabelledRuns,
    MappedZone,
    MappingDocument,
    MappingOptions,
    MapState,
    Pose,
    Scan,
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
from semtopo.geometry import count_vertices
from service import store
from service.errors import MapFullError, NoWorldError, UnknownSessionError
from service.notes import Notes
from service.stopwatch import Stopwatch

SESSION_BYTES = 5_000
WORLD_ZONE_BYTES = 1_300
MAP_ZONE_BYTES = 1_500
DOORWAY_BYTES = 1_500
NOTE_BYTES = 2_000
POINT_BYTES = 20
"""What a session takes in memory, and in it a zone of its world, a zone of its map with its
passages, a doorway with its own, and there a vertex or border point (measured: 1.2 kB, 1.3 kB,
1.4 kB, 17 bytes)."""

MAP_ZONES_MAX = 10_000
MAP_BYTES_MAX = 2**26  # some three million vertices and border points

LIGHT_READINGS = 200_000
"""Samples of a sensor times zones of a world: at most 2 ms to read, and some 100 zones to see."""

LIGHT_MAP_BYTES = 2**19
"""A larger map has zones whose union with what is seen may take more than some ms."""


@dataclass(frozen=True, slots=True, eq=False)
class HotSession:
    """A session in memory, as of step `state.seq`."""

    row: store.SessionRow
    """What does not change from step to step; its `version` is that of the time of loading."""
    world: World | None
    sensor: Sensor
    options: MappingOptions
    state: MapState
    step_ms: float = math.inf
    """What the last step took of a processor; unknown before the first."""
    map_bytes: int = 0
    """About what the map takes in memory."""
    notes: Notes = field(default_factory=Notes)

    @property
    def seq(self) -> int:
        """The last step that the map holds."""
        return self.state.seq

    @property
    def version(self) -> tuple[int, int, int]:
        """What it is known by: its number, its last step, and its number of changes."""
        return (self.row.number, self.state.seq, self.notes.revision)

    @property
    def tag(self) -> str:
        """The entity tag of the map as it is, whatever is noted about it (RFC 9110, 8.8.3)."""
        return entity_tag(self.row.number, self.state.seq)

    @property
    def weight(self) -> int:
        """About what the session takes in memory, in bytes."""
        world = 0 if self.world is None else len(self.world.zones)
        notes = NOTE_BYTES * (len(self.notes.zones) + len(self.notes.restrictions))
        return SESSION_BYTES + WORLD_ZONE_BYTES * world + self.map_bytes + notes

    @property
    def is_light(self) -> bool:
        """Whether no step can take very long, wherever in the world the robot is."""
        world = 0 if self.world is None else len(self.world.zones)
        readings = self.sensor.beams * self.sensor.samples * world
        return readings <= LIGHT_READINGS and self.map_bytes <= LIGHT_MAP_BYTES

    def after(self, state: MapState, step_ms: float) -> HotSession:
        """Return the session with the map after one more step, which took `step_ms`."""
        before, after = self.state.metric, state.metric
        if before is after:
            return replace(self, state=state, step_ms=step_ms)
        zones, doors = after.changed_since(before), after.doorways.changed_since(before.doorways)
        zone_ids = [*(it.zone_id for it in zones), *list(after.former)[len(before.former) :]]
        keys = [it.key for it in doors]
        keys += list(after.doorways.former)[len(before.doorways.former) :]
        old_zones = [before.zones[zone_id] for zone_id in zone_ids if zone_id in before.zones]
        old_doors = [before.doorways[key] for key in keys if key in before.doorways]
        grown = _parts_bytes(zones, doors) - _parts_bytes(old_zones, old_doors)
        return replace(self, state=state, step_ms=step_ms, map_bytes=self.map_bytes + grown)

    def take(self, pose: Pose, seen: LabelledRuns | None, watch: Stopwatch) -> Step:
        """Take one step: with what a real sensor saw, else with the simulated one.

        Raises
        ------
        NoWorldError
            There is neither a scan nor a world.
        MapFullError
            The map has, or would get, more than it may.
        """
        if self.map_bytes > MAP_BYTES_MAX:
            raise MapFullError("this map has as many points as it may")
        taken = step(self.state, self.look(pose, seen, watch), self.options, watch.ended)
        metric = taken.state.metric
        if len(metric.zones) + len(metric.former) > MAP_ZONES_MAX:
            raise MapFullError(f"a map has at most {MAP_ZONES_MAX} zones")
        return taken

    def look(self, pose: Pose, seen: LabelledRuns | None, watch: Stopwatch) -> Scan:
        """Return a scan: of what a real sensor saw, else of the world.

        Raises
        ------
        NoWorldError
            There is neither.
        """
        if seen is not None:
            scan = from_runs(pose, seen)
            watch.ended(Stage.ANALYSIS)
            return scan
        if self.world is None:
            raise NoWorldError("this session has no world to sense, so a step needs a scan")
        sensing = self.options.sensing
        return scan_world(self.world, self.sensor, pose.position, watch.ended, sensing=sensing)


def entity_tag(session: int, seq: int, notes: str = "") -> str:
    """Return the entity tag of a session's map as of step `seq`, with a version of its notes."""
    return f'"{session}-{seq}{notes}"'


def map_tag(tag: str) -> str:
    """Return an entity tag without the version of notes: steps do not depend on them."""
    number, dash, rest = tag.partition("-")
    return f'{number}{dash}{rest.partition("-")[0]}"' if "-" in rest else tag


def load(connection: Connection, session_id: str, known: HotSession | None) -> HotSession:
    """Return a session as it is stored; `known` itself, if it is up to date.

    Raises
    ------
    UnknownSessionError
        There is no session of that id.
    """
    if known is not None:
        found = store.find_version(connection, session_id)
        if found == known.version:
            return known
        if found is not None and found[:2] == known.version[:2]:
            changes = store.list_changes(connection, found[0], after=known.notes.revision)
            return replace(known, notes=known.notes.after(changes))
    row = store.find_session(connection, session_id)
    if row is None:
        raise UnknownSessionError("there is no session of that id")
    world = None if row.world is None else WorldDocument.model_validate_json(row.world).value()
    sensor = SensorDocument.model_validate_json(row.sensor).value()
    options = MappingDocument.model_validate_json(row.mapping).value()
    state = store.load_state(connection, row)
    notes = Notes().after(store.list_changes(connection, row.number) if row.revision else [])
    return HotSession(row, world, sensor, options, state, map_bytes=bytes_of(state), notes=notes)


def bytes_of(state: MapState) -> int:
    """Return about what a map takes in memory."""
    return _parts_bytes(state.metric.zones.values(), state.metric.doorways.values())


def _parts_bytes(zones: Iterable[MappedZone], doorways: Iterable[Doorway]) -> int:
    """Return about what zones and doorways of a map take in memory."""
    return sum(
        MAP_ZONE_BYTES + POINT_BYTES * (count_vertices(zone.region) + len(zone.border.xy))
        for zone in zones
    ) + sum(DOORWAY_BYTES + POINT_BYTES * count_vertices(door.region) for door in doorways)
