"""Rows of maps: zones and passages as they are, and zones as they were at checkpoints."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import orjson
from sqlalchemy import Connection, and_, bindparam, func, insert, select, update

from semtopo.codec import border_bytes, border_from, region_bytes, region_from
from semtopo.graph import Node, Passage, TopologyGraph
from semtopo.mapper import MapState
from semtopo.metric import MappedZone, MetricMap
from semtopo.types import Point
from service.statements import Statement, run
from service.store.log import find_step
from service.store.sessions import SessionRow
from service.tables import passages, zone_versions, zones

CHECKPOINT_EVERY = 64
"""Steps between checkpoints: an earlier map is at most 63 replayed steps away (some 0.2 s)."""

_ADD_ZONE = Statement(insert(zones))

_GROW_ZONE = Statement(
    update(zones)
    .where(zones.c.session == bindparam("session"), zones.c.zone_id == bindparam("zone_id"))
    .values({name: bindparam(name) for name in ("seq", "region", "border")})
)

_ADD_PASSAGE = Statement(insert(passages))


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


def _robot(connection: Connection, session: int, seq: int) -> tuple[Point | None, str | None]:
    """Return where the robot was at a step, and in which zone."""
    logged = find_step(connection, session, seq)
    if logged is None:
        return None, None
    pose = orjson.loads(logged.input)["pose"]
    answer = orjson.loads(logged.answer)
    # answers of early versions know the label alone, which then was the id
    return (pose["x"], pose["y"]), answer.get("zone_id", answer["here"])


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
