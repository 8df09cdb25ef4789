"""Both databases alike: the schema, the way to it, and what a transaction sees."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from alembic import command
from alembic.autogenerate import compare_metadata
from alembic.migration import MigrationContext
from sqlalchemy import insert, inspect, text
from sqlalchemy.exc import DBAPIError

from semtopo.formats import read_world
from semtopo.mapper import explore
from semtopo.sensor import Sensor
from semtopo.types import MappingOptions, Occupancy
from semtopo.wkb import shape_bytes, shape_from
from service import store
from service.database import Database, migrate, migration_config, open_database
from service.tables import metadata, passages, sessions, zones
from tests.service.twin import ROOT

WORLD = ROOT / "examples" / "paper" / "world.json"

pytestmark = pytest.mark.databases("sqlite", "postgres")

OLD_SESSION = (
    "INSERT INTO sessions (id, name, created_at, sensor, mapping, engine, version)"
    " VALUES ('a', '', '', '', '', '', 0)"
)

SESSION = {
    "id": "a", "name": "", "created_at": "", "sensor": "", "mapping": "", "engine": "",
    "version": 0,
}  # fmt: skip


@pytest.fixture
def url(new_database: Callable[[], str]) -> str:
    """Give the URL of a database that is empty, or not there yet."""
    return new_database()


@pytest.fixture
def database(url: str) -> Iterator[Database]:
    """Give an open database."""
    opened = open_database(url)
    yield opened
    opened.close()


def test_migrations_lead_to_the_tables_that_the_code_knows(database: Database) -> None:
    with database.writer.connect() as connection:
        context = MigrationContext.configure(
            connection, opts={"compare_type": True, "render_as_batch": True}
        )
        assert compare_metadata(context, metadata) == []


def test_constraints_are_the_same_in_migrations_and_code(
    database: Database, new_database: Callable[[], str]
) -> None:
    """Alembic compares no checks, nor what a deletion takes along; so they are compared here."""
    migrated = inspect(database.writer)
    from_code = open_database(new_database())
    with from_code.writer.begin() as connection:
        command.downgrade(migration_config(connection), "base")
        metadata.create_all(connection)
    created = inspect(from_code.writer)
    for table in metadata.tables:
        assert normal(created.get_foreign_keys(table)) == normal(migrated.get_foreign_keys(table))
        assert normal(created.get_check_constraints(table)) == normal(
            migrated.get_check_constraints(table)
        )
        assert normal(created.get_unique_constraints(table)) == normal(
            migrated.get_unique_constraints(table)
        )
        assert normal(created.get_indexes(table)) == normal(migrated.get_indexes(table))
        assert created.get_pk_constraint(table) == migrated.get_pk_constraint(table)
    from_code.close()


def normal(found: object) -> list[str]:
    """Return descriptions in an order that does not depend on where they came from."""
    assert isinstance(found, list)
    return sorted(re.sub(r"\s+", " ", str(sorted(one.items()))) for one in found)


def test_down_to_nothing_and_up_again(database: Database) -> None:
    with database.writer.begin() as connection:
        command.downgrade(migration_config(connection), "base")
    assert set(inspect(database.writer).get_table_names()) <= {"alembic_version", "sqlite_sequence"}
    migrate(database.writer)
    assert set(metadata.tables) <= set(inspect(database.writer).get_table_names())


def test_opening_again_changes_nothing(url: str) -> None:
    first = open_database(url)
    with first.writer.begin() as connection:
        connection.execute(insert(sessions).values(SESSION))
    first.close()
    again = open_database(url)
    with again.reader.begin() as connection:
        assert connection.execute(sessions.select()).mappings().one()["id"] == "a"
    again.close()


def test_a_migration_that_fails_leaves_the_schema_as_it_was(
    database: Database, monkeypatch: pytest.MonkeyPatch
) -> None:
    with database.writer.begin() as connection:
        command.downgrade(migration_config(connection), "base")
    before = inspect(database.writer).get_table_names()
    monkeypatch.setattr("alembic.operations.Operations.create_index", None)
    with pytest.raises(TypeError):
        migrate(database.writer)
    assert inspect(database.writer).get_table_names() == before


def test_readers_cannot_write(database: Database) -> None:
    with (
        database.reader.connect() as connection,
        pytest.raises(DBAPIError, match=r"readonly|read-only"),
    ):
        connection.execute(text("DELETE FROM sessions"))


def test_a_reader_sees_one_state(database: Database) -> None:
    count = text("SELECT count(*) FROM sessions")
    with database.reader.begin() as reader:
        before = reader.scalar(count)
        with database.writer.begin() as writer:
            writer.execute(insert(sessions).values(SESSION))
        assert reader.scalar(count) == before == 0
    with database.reader.begin() as reader:
        assert reader.scalar(count) == 1


def test_a_transaction_that_fails_leaves_nothing(database: Database) -> None:
    def change() -> None:
        with database.writer.begin() as writer:
            writer.execute(insert(sessions).values(SESSION))
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        change()
    with database.reader.begin() as reader:
        assert reader.scalar(text("SELECT count(*) FROM sessions")) == 0


OPEN_AT_ONCE = """
import os, sys, time
from service.database import open_database

for url in sys.argv[1:]:
    start = time.monotonic() + 0.2
    children = []
    for _ in range(6):
        child = os.fork()
        if child == 0:
            time.sleep(max(0, start - time.monotonic()))
            open_database(url).close()
            os._exit(0)
        children.append(child)
    assert [os.waitpid(child, 0)[1] for child in children] == [0] * 6
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")
def test_several_processes_open_a_new_database_at_once(new_database: Callable[[], str]) -> None:
    """Each of them migrates, or waits for the one that does."""
    urls = [new_database() for _ in range(4)]
    command_line = [sys.executable, "-c", OPEN_AT_ONCE, *urls]
    done = subprocess.run(command_line, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[-3000:]
    for url in urls:
        opened = open_database(url)
        assert set(metadata.tables) <= set(inspect(opened.writer).get_table_names())
        opened.close()


def test_alembic_at_the_command_line_finds_its_settings(url: str) -> None:
    alembic = Path(sys.executable).with_name("alembic")
    open_database(url).close()
    done = subprocess.run(
        [alembic, "current"],
        cwd=ROOT,
        env={"SEMTOPO_DATABASE": url},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert "0007 (head)" in done.stdout


def test_worlds_of_an_older_database_stay(database: Database) -> None:
    with database.writer.begin() as connection:
        command.downgrade(migration_config(connection), "0004")
        connection.execute(insert(sessions).values(SESSION))
        connection.execute(insert(sessions).values(SESSION | {"id": "b"}))
        connection.execute(text("UPDATE sessions SET world = 'w' WHERE id = 'b'"))
    for _ in range(2):  # there, and back, and there again
        migrate(database.writer)
        with database.writer.begin() as connection:
            found = {it: store.find_session(connection, it) for it in "ab"}
            assert {it: row and row.world for it, row in found.items()} == {"a": None, "b": "w"}
            command.downgrade(migration_config(connection), "0004")
            kept = connection.execute(text("SELECT id, world FROM sessions ORDER BY id")).all()
            assert [tuple(row) for row in kept] == [("a", None), ("b", "w")]


def test_sessions_of_an_older_database_keep_their_checkpoints(database: Database) -> None:
    with database.writer.begin() as connection:
        command.downgrade(migration_config(connection), "0006")
        connection.execute(text(OLD_SESSION))
    migrate(database.writer)
    with database.writer.begin() as connection:
        row = store.find_session(connection, "a")
        assert row is not None
        assert row.checkpoint_every == 64


def test_passages_of_an_older_database_stay(database: Database) -> None:
    """What was stored before there were numbers has number 0, and is there still."""
    zone = "INSERT INTO zones VALUES (1, '{0}', {1}, '{0}', 1, 1, '', '')"
    with database.writer.begin() as connection:
        command.downgrade(migration_config(connection), "0001")
        connection.execute(insert(sessions).values(SESSION | {"number": 1}))
        for number, label in enumerate("ab"):
            connection.execute(text(zone.format(label, number)))
        connection.execute(text("INSERT INTO passages VALUES (1, 'a', 'b', 0, 0.1, 0.2, 1)"))
    migrate(database.writer)
    with database.writer.begin() as connection:
        (edge,) = connection.execute(passages.select()).mappings()
        assert edge == {
            "session": 1, "source": "a", "target": "b", "number": 0, "position": 0,
            "x": 0.1, "y": 0.2, "seq": 1, "moved": 0, "until": None,
        }  # fmt: skip
        assert len(connection.execute(zones.select()).all()) == 2
        command.downgrade(migration_config(connection), "0001")
        assert len(connection.execute(text("SELECT * FROM passages")).all()) == 1
        assert len(connection.execute(text("SELECT * FROM zones")).all()) == 2


@pytest.mark.parametrize("tolerance", [0.0, 0.02])
def test_borders_of_an_older_database_stay(database: Database, tolerance: float) -> None:
    """Points on borders were stored with their places; what lies between them follows."""
    options = MappingOptions(tolerance=tolerance)
    walk = [(1.0, 6.0), (2.03, 6.03), (2.0, 7.0)]
    *_, last = explore(read_world(WORLD.read_bytes()), Sensor(36, 2.0, 20), walk, options)
    mapped = last.state.metric.zones.values()
    with database.writer.begin() as connection:
        number = connection.scalar(insert(sessions).values(SESSION).returning(sessions.c.number))
        for position, zone in enumerate(mapped):
            region, border = shape_bytes(zone)
            about = {"zone_id": zone.zone_id, "label": zone.label, "since": 1, "seq": zone.seq}
            place = {"session": number, "position": position, "region": region, "border": border}
            connection.execute(insert(zones).values(about | place))
        command.downgrade(migration_config(connection), "0005")
        stored = connection.execute(zones.select().order_by(zones.c.position)).all()
        for zone, row in zip(mapped, stored, strict=True):
            known = len((zone.core or zone).border.occupancy.nonzero()[0])
            assert len(row.border) == 17 * known + (8 if tolerance else 0)
    migrate(database.writer)
    with database.reader.begin() as connection:
        stored = connection.execute(zones.select().order_by(zones.c.position)).all()
        for zone, row in zip(mapped, stored, strict=True):
            extent, core = shape_from(row.region, row.border)
            assert extent.region.equals_exact(zone.region)
            assert (core is None) == (tolerance == 0)
            found, wanted = (core or extent).border, (zone.core or zone).border
            assert found.xy.tobytes() == wanted.xy.tobytes()
            assert found.occupancy.tolist() == wanted.occupancy.tolist()
            walls = wanted.sides == Occupancy.OBSTACLE
            assert (found.sides[walls] == Occupancy.OBSTACLE).sum() >= 0.8 * walls.sum()
            assert (found.sides > Occupancy.NONE).all()
