"""Rows of zones: as they are, as they were at checkpoints, and what they were merged into."""

from __future__ import annotations

from typing import Any

from sqlalchemy import Connection, and_, bindparam, func, insert, or_, select, update

from semtopo.metric import MappedZone, MetricMap
from semtopo.wkb import shape_bytes, shape_from
from service.statements import Statement, run
from service.tables import zone_versions, zones

_ADD = Statement(insert(zones))

_MINE = (zones.c.session == bindparam("session"), zones.c.zone_id == bindparam("zone_id"))

_GROW = Statement(
    update(zones)
    .where(*_MINE)
    .values({name: bindparam(name) for name in ("seq", "region", "border")})
)

_MERGE = Statement(
    update(zones).where(*_MINE).values({name: bindparam(name) for name in ("until", "merged_into")})
)


def load_zones(connection: Connection, session: int) -> dict[str, MappedZone]:
    """Return the zones of a session as they are, by their ids, in order of finding."""
    query = (
        select(zones)
        .where(zones.c.session == session, zones.c.until.is_(None))
        .order_by(zones.c.position)
    )
    return {row.zone_id: _zone(row) for row in connection.execute(query)}


def load_zones_at(connection: Connection, session: int, checkpoint: int) -> dict[str, MappedZone]:
    """Return the zones of a session as they were at a checkpoint."""
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
        .where(
            zones.c.session == session, or_(zones.c.until.is_(None), zones.c.until > checkpoint)
        )
        .order_by(zones.c.position)
    )  # fmt: skip
    return {row.zone_id: _zone(row) for row in connection.execute(query)}


def load_merges(connection: Connection, session: int, seq: int) -> dict[str, str]:
    """Return into which zones others had been merged by step `seq`."""
    query = (
        select(zones.c.zone_id, zones.c.merged_into)
        .where(zones.c.session == session, zones.c.until <= seq)
        .order_by(zones.c.until, zones.c.position)
    )
    return {row.zone_id: row.merged_into for row in connection.execute(query)}


def save_zones(
    connection: Connection, session: int, before: MetricMap, after: MetricMap, seq: int
) -> None:
    """Write the zones that step `seq` found, changed, or merged into others."""
    position = len(before.zones) + len(before.former)
    for zone in after.changed_since(before):
        region, border = shape_bytes(zone)
        values = {
            "session": session, "zone_id": zone.zone_id, "seq": zone.seq,
            "region": region, "border": border,
        }  # fmt: skip
        if zone.zone_id in before.zones:
            run(connection, _GROW, values)
        else:
            head = {"position": position, "label": zone.label, "since": zone.since}
            run(connection, _ADD, {**values, **head, "until": None, "merged_into": None})
            position += 1
    for zone_id in list(after.former)[len(before.former) :]:
        values = {"session": session, "zone_id": zone_id}
        run(connection, _MERGE, {**values, "until": seq, "merged_into": after.former[zone_id]})


def add_zone_versions(
    connection: Connection, session: int, checkpoint: int, metric: MetricMap, since: int
) -> None:
    """Write, at a checkpoint, the zones that changed after step `since`."""
    rows = [
        {
            "session": session, "zone_id": zone.zone_id, "checkpoint": checkpoint, "seq": zone.seq,
            **dict(zip(("region", "border"), shape_bytes(zone), strict=True)),
        }
        for zone in metric.zones.values()
        if zone.seq > since
    ]  # fmt: skip
    if rows:
        connection.execute(insert(zone_versions), rows)


def _zone(row: Any) -> MappedZone:  # noqa: ANN401 -- rows of two queries, typed by neither
    ground, core = shape_from(row.region, row.border)
    return MappedZone(row.zone_id, row.label, ground, row.since, row.seq, core)
