"""Maps of sessions: as they are, and as they were at checkpoints."""

from __future__ import annotations

import orjson
from sqlalchemy import Connection

from semtopo.mapper import MapState
from semtopo.metric import MetricMap
from semtopo.types import Point
from service.store.doorways import (
    add_doorway_versions,
    load_doorways,
    load_doorways_at,
    save_doorways,
)
from service.store.graph import load_graph, save_passages
from service.store.log import find_step
from service.store.sessions import SessionRow
from service.store.zones import (
    add_zone_versions,
    load_merges,
    load_zones,
    load_zones_at,
    save_zones,
)


def load_state(connection: Connection, row: SessionRow) -> MapState:
    """Return the current map of a session."""
    session, seq = row.number, row.version
    metric = MetricMap(
        load_zones(connection, session),
        load_doorways(connection, session, seq),
        load_merges(connection, session, seq),
    )
    return MapState(seq, metric, load_graph(connection, session), *_robot(connection, session, seq))


def load_checkpoint(connection: Connection, row: SessionRow, seq: int) -> MapState:
    """Return the map of a session at the last checkpoint up to step `seq`."""
    session, checkpoint = row.number, seq - seq % row.checkpoint_every
    metric = MetricMap(
        load_zones_at(connection, session, checkpoint),
        load_doorways_at(connection, session, checkpoint),
        load_merges(connection, session, checkpoint),
    )
    graph = load_graph(connection, session).at(checkpoint)
    return MapState(checkpoint, metric, graph, *_robot(connection, session, checkpoint))


def save_changes(
    connection: Connection, row: SessionRow, before: MapState, after: MapState
) -> None:  # fmt: skip
    """Write the zones, passages and doorways in which one map differs from the one before it."""
    session = row.number
    save_zones(connection, session, before.metric, after.metric, after.seq)
    save_passages(connection, session, before.graph, after.graph)
    save_doorways(connection, session, before.metric.doorways, after.metric.doorways, after.seq)
    if after.seq % row.checkpoint_every == 0:
        since = after.seq - row.checkpoint_every
        add_zone_versions(connection, session, after.seq, after.metric, since)
        add_doorway_versions(connection, session, after.seq, after.metric.doorways, since)


def _robot(connection: Connection, session: int, seq: int) -> tuple[Point | None, str | None]:
    """Return where the robot was at a step, and in which zone."""
    logged = find_step(connection, session, seq)
    if logged is None:
        return None, None
    pose, answer = orjson.loads(logged.input)["pose"], orjson.loads(logged.answer)
    # answers of early versions know the label alone, which then was the id
    return (pose["x"], pose["y"]), answer.get("zone_id", answer["here"])
