"""Sessions that nobody uses are deleted, if the settings say so, and no others."""

from __future__ import annotations

import time
from collections.abc import Callable
from datetime import UTC, datetime, timedelta

import pytest
from sqlalchemy import update

from service import store
from service.clock import written
from service.database import open_database
from service.tables import metadata, sessions, steps
from tests.servers import Server
from tests.service.test_store import logged, new

pytestmark = pytest.mark.databases("sqlite", "postgres")

DAY = "2026-01-{:02}T00:00:00.000+00:00"


def test_a_time_sorts_as_it_follows() -> None:
    begun = datetime(2026, 1, 1, 23, 59, 59, 999_600, tzinfo=UTC)
    times = [written(begun + timedelta(milliseconds=step)) for step in range(0, 90_000, 777)]
    assert times == sorted(times)


def test_unused_is_what_began_and_took_no_step_since(new_database: Callable[[], str]) -> None:
    database = open_database(new_database())
    with database.writer.begin() as connection:
        for name, begun, taken in (
            ("old", 1, []), ("driven", 1, [2, 9]), ("old driven", 1, [2, 3]), ("young", 9, []),
        ):  # fmt: skip
            number = store.add_session(connection, new(name))
            mine = sessions.c.number == number
            connection.execute(update(sessions).where(mine).values(created_at=DAY.format(begun)))
            for seq, day in enumerate(taken, start=1):
                store.add_step(connection, number, logged(seq, None))
                at = (steps.c.session == number) & (steps.c.seq == seq)
                connection.execute(update(steps).where(at).values(taken_at=DAY.format(day)))
                assert store.advance(connection, number, seq - 1)
    with database.writer.begin() as connection:
        before = DAY.format(5)
        assert store.list_unused(connection, before, 10) == ["old", "old driven"]
        assert store.list_unused(connection, before, 1) == ["old"]
        for name in ("driven", "young", "nowhere"):
            assert not store.delete_unused(connection, name, before)
        for name in ("old", "old driven"):
            assert store.delete_unused(connection, name, before)
        assert store.list_unused(connection, DAY.format(30), 10) == ["driven", "young"]
    with database.reader.begin() as connection:
        rows = {table: connection.execute(table.select()).all() for table in metadata.sorted_tables}
        assert len(rows[sessions]) == 2
        assert len(rows[steps]) == 2
    database.close()


def test_a_server_deletes_what_is_not_used(
    new_database: Callable[[], str], tmp_path_factory: pytest.TempPathFactory
) -> None:
    """The time to live is 2 s here; one session goes on, the other does not."""
    days = 2 / 86_400
    server = Server(tmp_path_factory.mktemp("retention"), new_database(), keep_days=days)
    server.start()
    idle, used = server.create(), server.create()
    give_up = time.monotonic() + 60
    scan = {"angle_min": 0, "angle_increment": 1, "range_max": 2, "beams": []}
    while server.client.get(idle).status_code == 200:
        server.step(used, {"pose": {"x": 0, "y": 0}, "scan": scan})
        assert time.monotonic() < give_up
        time.sleep(0.1)
    assert server.client.get(idle).json()["code"] == "unknown_session"
    assert server.client.get(used).json()["seq"] > 10
    server.close()
    assert server.faults() == []
