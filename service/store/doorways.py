"""Rows of doorways: as they are, as they were at checkpoints, and what they became part of."""

from __future__ import annotations

from typing import Any

from sqlalchemy import Connection, and_, bindparam, func, insert, or_, select, update

from semtopo.doorways import Doorway, DoorwayKey, Doorways
from semtopo.wkb import region_bytes, region_from
from service.statements import Statement, run
from service.tables import doorway_versions, doorways

_KEY = ("one", "other", "number")

_BECAME = ("became_one", "became_other", "became_number")

_ADD = Statement(insert(doorways))

_MINE = [doorways.c[name] == bindparam(f"at_{name}") for name in ("session", *_KEY)]

_GROW = Statement(
    update(doorways).where(*_MINE).values({name: bindparam(name) for name in ("seq", "region")})
)

_JOIN = Statement(
    update(doorways).where(*_MINE).values({name: bindparam(name) for name in ("until", *_BECAME)})
)


def load_doorways(connection: Connection, session: int, seq: int) -> Doorways:
    """Return the doorways of a session as they are; `seq` is its last step."""
    query = (
        select(doorways)
        .where(doorways.c.session == session, doorways.c.until.is_(None))
        .order_by(doorways.c.position)
    )
    known = map(_doorway, connection.execute(query))
    return Doorways({door.key: door for door in known}, _load_former(connection, session, seq))


def load_doorways_at(connection: Connection, session: int, checkpoint: int) -> Doorways:
    """Return the doorways of a session as they were at a checkpoint."""
    versions = doorway_versions.c
    key = [versions[name] for name in _KEY]
    newest = (
        select(*key, func.max(versions.checkpoint).label("checkpoint"))
        .where(versions.session == session, versions.checkpoint <= checkpoint)
        .group_by(*key)
        .subquery()
    )
    same = [newest.c[name] == versions[name] for name in (*_KEY, "checkpoint")]
    query = (
        select(
            *(doorways.c[name] for name in (*_KEY, "since")), versions.seq, versions.region
        )
        .join(
            doorway_versions,
            and_(
                versions.session == session, *(versions[name] == doorways.c[name] for name in _KEY)
            ),
        )
        .join(newest, and_(*same))
        .where(
            doorways.c.session == session,
            or_(doorways.c.until.is_(None), doorways.c.until > checkpoint),
        )
        .order_by(doorways.c.position)
    )  # fmt: skip
    known = map(_doorway, connection.execute(query))
    return Doorways(
        {door.key: door for door in known}, _load_former(connection, session, checkpoint)
    )


def save_doorways(
    connection: Connection, session: int, before: Doorways, after: Doorways, seq: int
) -> None:
    """Write the doorways that step `seq` found, changed, or made part of others."""
    if after is before:
        return
    position = len(before) + len(before.former)
    for door in after.changed_since(before):
        changed = {"seq": door.seq, "region": region_bytes(door.region)}
        if door.key in before:
            run(connection, _GROW, {**_at(session, door.key), **changed})
        else:
            head = {"session": session, **dict(zip(_KEY, door.key, strict=True))}
            rest = {"position": position, "since": door.since, "until": None}
            run(connection, _ADD, {**head, **rest, **changed, **dict.fromkeys(_BECAME)})
            position += 1
    for key in list(after.former)[len(before.former) :]:
        became = dict(zip(_BECAME, after.former[key], strict=True))
        run(connection, _JOIN, {**_at(session, key), "until": seq, **became})


def add_doorway_versions(
    connection: Connection, session: int, checkpoint: int, known: Doorways, since: int
) -> None:
    """Write, at a checkpoint, the doorways that changed after step `since`."""
    rows = [
        {
            "session": session, **dict(zip(_KEY, door.key, strict=True)), "checkpoint": checkpoint,
            "seq": door.seq, "region": region_bytes(door.region),
        }
        for door in known.values()
        if door.seq > since
    ]  # fmt: skip
    if rows:
        connection.execute(insert(doorway_versions), rows)


def _load_former(connection: Connection, session: int, seq: int) -> dict[DoorwayKey, DoorwayKey]:
    """Return what doorways had become part of others by step `seq`."""
    query = (
        select(*(doorways.c[name] for name in (*_KEY, *_BECAME)))
        .where(doorways.c.session == session, doorways.c.until <= seq)
        .order_by(doorways.c.until, doorways.c.position)
    )
    return {
        (row.one, row.other, row.number): (row.became_one, row.became_other, row.became_number)
        for row in connection.execute(query)
    }


def _at(session: int, key: DoorwayKey) -> dict[str, Any]:
    """Return the values that find the row of a doorway."""
    return {
        "at_session": session,
        **dict(zip(("at_one", "at_other", "at_number"), key, strict=True)),
    }


def _doorway(row: Any) -> Doorway:  # noqa: ANN401 -- rows of two queries, typed by neither
    ends, region = (row.one, row.other), region_from(row.region)
    return Doorway(ends, row.number, region, since=row.since, seq=row.seq)
