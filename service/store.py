"""Keep sessions, steps and maps in a database: the only room that speaks SQL.

Every function works on a connection that is in a transaction; whoever calls it commits. A step, its
answer, the rows it changed and the new version belong to one transaction.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, fields
from typing import Any

import orjson
from sqlalchemy import Connection, Row, and_, bindparam, delete, func, insert, select, update

from semtopo.codec import border_bytes, border_from, region_bytes, region_from
from semtopo.graph import Node, Passage, TopologyGraph
from semtopo.mapper import MapState
from semtopo.metric import MappedZone, MetricMap
from semtopo.types import Point
from service.statements import Statement, run
from service.tables import passages, sessions, steps, zone_versions, zones

CHECKPOINT_EVERY = 64
"""Steps between checkpoints: an earlier map is at most 63 replayed steps away (some 0.2 s)."""

PAGE_CHARACTERS = 2**22
"""Of input and answers in one page of the log; a step may bring a scan of 1 MiB."""

FETCHED_AT_ONCE = 16
"""Steps of the log."""

_ADVANCE = Statement(
    update(sessions)
    .where(
        sessions.c.number == bindparam("at_number"), sessions.c.version == bindparam("at_version")
    )
    .values(version=bindparam("version"))
)
_ADD_STEP = Statement(insert(steps))
_ADD_ZONE = Statement(insert(zones))
_GROW_ZONE = Statement(
    update(zones)
    .where(zones.c.session == bindparam("session"), zones.c.zone_id == bindparam("zone_id"))
    .values({name: bindparam(name) for name in ("seq", "region", "border")})
)
_ADD_PASSAGE = Statement(insert(passages))


@dataclass(frozen=True, slots=True, kw_only=True)
class SessionHead:
    """What a listing tells of a session; `version` is the seq of its last step."""

    number: int
    id: str
    name: str
    created_at: str
    version: int


@dataclass(frozen=True, slots=True, kw_only=True)
class SessionRow(SessionHead):
    """A session as it is stored; world, sensor and mapping are JSON."""

    owner: int | None
    world: str | None
    sensor: str
    mapping: str
    engine: str


@dataclass(frozen=True, slots=True)
class NewSession:
    """A session to be stored."""

    id: str
    name: str
    created_at: str
    world: str | None
    sensor: str
    mapping: str
    engine: str
    owner: int | None = None


@dataclass(frozen=True, slots=True)
class LoggedStep:
    """A step as it is stored: what came in, and what was answered, in JSON."""

    seq: int
    taken_at: str
    key: str | None
    fingerprint: bytes
    input: str
    answer: str


def add_session(connection: Connection, new: NewSession) -> None:
    """Store a new session, with an empty map."""
    values = {name: getattr(new, name) for name in NewSession.__slots__}
    connection.execute(insert(sessions).values(version=0, **values))


def find_session(connection: Connection, session_id: str) -> SessionRow | None:
    """Return a session, or `None` if there is none of that id."""
    query = select(sessions).where(sessions.c.id == session_id)
    row = connection.execute(query).mappings().one_or_none()
    return None if row is None else SessionRow(**row)


def list_sessions(
    connection: Connection, owner: int | None, after: int, limit: int
) -> list[SessionHead]:
    """Return up to `limit` sessions, oldest first, whose number is above `after`.

    With an owner, only the sessions made with that API key.
    """
    columns = [sessions.c[field.name] for field in fields(SessionHead)]
    query = select(*columns).where(sessions.c.number > after).order_by(sessions.c.number)
    if owner is not None:
        query = query.where(sessions.c.owner == owner)
    return [SessionHead(**row) for row in connection.execute(query.limit(limit)).mappings()]


def delete_session(connection: Connection, session_id: str) -> bool:
    """Delete a session with all that belongs to it; say whether there was one."""
    return connection.execute(delete(sessions).where(sessions.c.id == session_id)).rowcount > 0


def find_version(connection: Connection, session_id: str) -> tuple[int, int] | None:
    """Return the number of a session and the seq of its last step; `None` if there is none."""
    query = select(sessions.c.number, sessions.c.version).where(sessions.c.id == session_id)
    row = connection.execute(query).one_or_none()
    return None if row is None else (row.number, row.version)


def load_state(connection: Connection, row: SessionRow) -> MapState:
    """Return the current map of a session."""
    query = select(zones).where(zones.c.session == row.number).order_by(zones.c.position)
    mapped = {zone.zone_id: _zone(zone) for zone in connection.execute(query)}
    graph = _graph(connection, row.number, mapped)
    return MapState(
        row.version, MetricMap(mapped), graph, *_robot(connection, row.number, row.version)
    )


def load_checkpoint(connection: Connection, session: int, seq: int) -> MapState:
    """Return the map of a session at the last checkpoint up to step `seq`."""
    checkpoint = seq - seq % CHECKPOINT_EVERY
    newest = (
        select(zone_versions.c.zone_id, func.max(zone_versions.c.checkpoint).label("checkpoint"))
        .where(zone_versions.c.session == session, zone_versions.c.checkpoint <= checkpoint)
        .group_by(zone_versions.c.zone_id)
        .subquery()
    )
    versions = zone_versions.c
    query = (
        select(
            zones.c.zone_id, zones.c.label, zones.c.since,
            versions.seq, versions.region, versions.border,
        )
        .join(zone_versions, and_(versions.session == session, versions.zone_id == zones.c.zone_id))
        .join(
            newest,
            and_(
                newest.c.zone_id == versions.zone_id, newest.c.checkpoint == versions.checkpoint
            ),
        )
        .where(zones.c.session == session)
        .order_by(zones.c.position)
    )  # fmt: skip
    mapped = {zone.zone_id: _zone(zone) for zone in connection.execute(query)}
    graph = _graph(connection, session, mapped).at(checkpoint)
    return MapState(checkpoint, MetricMap(mapped), graph, *_robot(connection, session, checkpoint))


def find_step(connection: Connection, session: int, seq: int) -> LoggedStep | None:
    """Return one step of a session, or `None` if it was not taken yet."""
    return _one_step(connection, session, steps.c.seq == seq)


def find_step_by_key(connection: Connection, session: int, key: str) -> LoggedStep | None:
    """Return the step of a session that was sent with an Idempotency-Key, if any."""
    return _one_step(connection, session, steps.c.key == key)


def list_steps(
    connection: Connection, session: int, after: int, limit: int
) -> Iterator[LoggedStep]:  # fmt: skip
    """Yield up to `limit` steps of a session whose seq is above `after`, in order.

    They are fetched a few at a time, since together they may be very large.
    """
    query = select(steps).where(steps.c.session == session, steps.c.seq > after)
    few = query.order_by(steps.c.seq).limit(limit).execution_options(yield_per=FETCHED_AT_ONCE)
    with connection.execute(few) as rows:
        yield from map(_logged, rows)


def page_of_steps(
    connection: Connection, session: int, after: int, limit: int
) -> tuple[list[LoggedStep], bool]:
    """Return up to `limit` steps after step `after`, in order, and whether more follow.

    A page is shorter where it would else have more than `PAGE_CHARACTERS`, but never empty.
    """
    page: list[LoggedStep] = []
    size = 0
    for logged in list_steps(connection, session, after, limit + 1):
        size += len(logged.input) + len(logged.answer)
        if page and (len(page) == limit or size > PAGE_CHARACTERS):
            return page, True
        page.append(logged)
    return page, False


def advance(connection: Connection, session: int, base: int) -> bool:
    """Move a session from version `base` to the next; say whether it was at `base`.

    Where several processes write, the first one wins, and locks the session until it commits.
    """
    values = {"at_number": session, "at_version": base, "version": base + 1}
    return run(connection, _ADVANCE, values) == 1


def add_step(connection: Connection, session: int, logged: LoggedStep) -> None:
    """Append a step to the log."""
    values = {name: getattr(logged, name) for name in LoggedStep.__slots__}
    run(connection, _ADD_STEP, {"session": session, **values})


def save_changes(
    connection: Connection, session: int, before: MapState, after: MapState
) -> None:  # fmt: skip
    """Write the zones and passages in which one map differs from the one before it."""
    _save_zones(connection, session, before.metric, after.metric)
    _add_passages(connection, session, before.graph, after.graph)
    if after.seq % CHECKPOINT_EVERY == 0:
        since = after.seq - CHECKPOINT_EVERY
        grown = [zone for zone in after.metric.zones.values() if zone.seq > since]
        _add_versions(connection, session, after.seq, grown)


def _save_zones(
    connection: Connection, session: int, before: MetricMap, after: MetricMap
) -> None:  # fmt: skip
    positions = {zone_id: number for number, zone_id in enumerate(after.zones)}
    for zone in after.changed_since(before):
        values = {
            "session": session, "zone_id": zone.zone_id, "position": positions[zone.zone_id],
            "label": zone.label, "since": zone.since, "seq": zone.seq,
            "region": region_bytes(zone.region), "border": border_bytes(zone.border),
        }  # fmt: skip
        run(connection, _GROW_ZONE if zone.zone_id in before.zones else _ADD_ZONE, values)


def _add_passages(
    connection: Connection, session: int, before: TopologyGraph, after: TopologyGraph
) -> None:  # fmt: skip
    new = list(after.passages.values())[len(before.passages) :]
    for position, edge in enumerate(new, start=len(before.passages)):
        values = {
            "session": session, "source": edge.source, "target": edge.target, "seq": edge.seq,
            "position": position, "x": edge.point[0], "y": edge.point[1],
        }  # fmt: skip
        run(connection, _ADD_PASSAGE, values)


def _add_versions(
    connection: Connection, session: int, checkpoint: int, grown: Sequence[MappedZone]
) -> None:  # fmt: skip
    rows = [
        {
            "session": session, "zone_id": zone.zone_id, "checkpoint": checkpoint, "seq": zone.seq,
            "region": region_bytes(zone.region), "border": border_bytes(zone.border),
        }
        for zone in grown
    ]  # fmt: skip
    if rows:
        connection.execute(insert(zone_versions), rows)


def _one_step(connection: Connection, session: int, which: Any) -> LoggedStep | None:  # noqa: ANN401 -- a SQL condition
    query = select(steps).where(steps.c.session == session, which)
    row = connection.execute(query).one_or_none()
    return None if row is None else _logged(row)


def _robot(connection: Connection, session: int, seq: int) -> tuple[Point | None, str | None]:
    """Return where the robot was at a step, and in which zone."""
    logged = find_step(connection, session, seq)
    if logged is None:
        return None, None
    pose = orjson.loads(logged.input)["pose"]
    return (pose["x"], pose["y"]), orjson.loads(logged.answer)["here"]


def _logged(row: Row[Any]) -> LoggedStep:
    return LoggedStep(**{name: getattr(row, name) for name in LoggedStep.__slots__})


def _zone(row: Any) -> MappedZone:  # noqa: ANN401 -- rows of two queries, typed by neither
    region, border = region_from(row.region), border_from(row.border)
    return MappedZone(row.zone_id, row.label, region, border, since=row.since, seq=row.seq)


def _graph(connection: Connection, session: int, mapped: dict[str, MappedZone]) -> TopologyGraph:
    """Return the graph of a session over the given zones."""
    query = select(passages).where(passages.c.session == session).order_by(passages.c.position)
    edges: Iterable[Passage] = (
        Passage(row.source, row.target, (row.x, row.y), row.seq)
        for row in connection.execute(query)
    )
    nodes = {key: Node(key, zone.label, zone.since) for key, zone in mapped.items()}
    return TopologyGraph(nodes, {edge.key: edge for edge in edges})
