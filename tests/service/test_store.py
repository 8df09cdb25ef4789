"""Maps in the database: what is stored comes back to the bit, and nothing impossible goes in."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache
from itertools import pairwise
from pathlib import Path
from unittest.mock import patch

import pytest
import shapely
from hypothesis import HealthCheck, given, settings
from sqlalchemy import Connection, delete, event, func, insert, select, update
from sqlalchemy.exc import IntegrityError

from semtopo.codec import graph_body, to_json, zones_body
from semtopo.doorways import Doorways
from semtopo.mapper import MapState, explore
from semtopo.types import MappingOptions
from service import store
from service.database import Database, open_database
from service.keys import add_key
from service.store import CHECKPOINT_EVERY, LoggedStep, NewSession, SessionRow
from service.tables import (
    doorway_versions,
    doorways,
    metadata,
    passages,
    sessions,
    steps,
    zone_versions,
    zones,
)
from tests.servers import Json
from tests.service.twin import Twin, paper_steps, paper_world
from tests.strategies import Scene, all_options, options, scenes

pytestmark = pytest.mark.databases("sqlite", "postgres")

STEPS = 140  # beyond four checkpoints

CHECKPOINTS = "service.store.sessions.CHECKPOINT_EVERY"


@pytest.fixture(scope="module")
def database(new_database: Callable[[], str]) -> Iterator[Database]:
    """Give a database."""
    opened = open_database(new_database())
    yield opened
    opened.close()


@pytest.fixture
def connection(database: Database) -> Iterator[Connection]:
    """Give a connection in a transaction that is undone after the test."""
    with database.writer.connect() as opened:
        yield opened
        opened.rollback()


@cache
def long_run() -> tuple[MapState, ...]:
    """Return all states of the paper's run, there and part of the way back."""
    path = (paper_steps() + paper_steps()[::-1])[:STEPS]
    return tuple(Twin.driven({"world": paper_world(), "sensor": {"beams": 36}}, path).states)


def new(session_id: str = "one", **changed: str) -> NewSession:
    values = {"name": "n", "created_at": "2026", "world": "{}", "sensor": "{}", "mapping": "{}"}
    return NewSession(**{"id": session_id, "engine": "0", **values, **changed})  # type: ignore[arg-type]


def logged(seq: int, key: str | None = None) -> LoggedStep:
    return LoggedStep(seq, "2026", key, b"\x01" * 32, '{"in":1}', '{"out":1}')


def logged_as(after: MapState) -> LoggedStep:
    """Return the log's entry of the step that led to a map."""
    assert after.position is not None
    x, y = after.position
    given = to_json({"pose": {"x": x, "y": y}}).decode()
    here = None if after.here is None else after.metric.zones[after.here].label
    answer = to_json({"here": here, "zone_id": after.here}).decode()
    return replace(logged(after.seq), input=given, answer=answer)


def saved(
    connection: Connection, states: tuple[MapState, ...], session_id: str = "one", **about: str
) -> SessionRow:
    """Store a run step by step, as the service does, and return the session."""
    key = store.CreationKey(session_id, b"\x01" * 32)
    assert store.begin_session(connection, new(session_id, **about), key) == session_id
    row = store.find_session(connection, session_id)
    assert row is not None
    for before, after in pairwise(states):
        assert store.advance(connection, row.number, before.seq)
        store.add_step(connection, row.number, logged_as(after))
        store.save_changes(connection, row, before, after)
    row = store.find_session(connection, session_id)
    assert row is not None
    return row


def assert_same(found: MapState, wanted: MapState) -> None:
    """Compare two maps to the last bit: order, polygons as they are written, borders, passages."""
    assert (found.seq, found.here) == (wanted.seq, wanted.here)
    assert found.position == wanted.position
    assert list(found.metric.zones) == list(wanted.metric.zones)
    for one, other in zip(found.metric.zones.values(), wanted.metric.zones.values(), strict=True):
        assert (one.zone_id, one.label, one.since, one.seq) == (
            other.zone_id, other.label, other.since, other.seq,
        )  # fmt: skip
        assert shapely.to_wkb(one.region) == shapely.to_wkb(other.region)
        assert one.border.xy.tobytes() == other.border.xy.tobytes()
        assert one.border.xy.shape == other.border.xy.shape
        assert one.border.occupancy.tolist() == other.border.occupancy.tolist()
    assert list(found.graph.nodes.items()) == list(wanted.graph.nodes.items())
    assert list(found.graph.passages.items()) == list(wanted.graph.passages.items())
    assert found.graph.gone == wanted.graph.gone
    assert_same_doorways(found.metric.doorways, wanted.metric.doorways)
    assert found.metric.former == wanted.metric.former
    assert zones_body(found) == zones_body(wanted)
    assert graph_body(found.graph, found.seq) == graph_body(wanted.graph, wanted.seq)


def assert_same_doorways(found: Doorways, wanted: Doorways) -> None:
    assert list(found) == list(wanted)
    assert found.former == wanted.former
    for one, other in zip(found.values(), wanted.values(), strict=True):
        assert (one.key, one.since, one.seq) == (other.key, other.since, other.seq)
        assert shapely.to_wkb(one.region) == shapely.to_wkb(other.region)


def test_an_empty_map_comes_back(connection: Connection) -> None:
    row = saved(connection, (MapState(),))
    assert_same(store.load_state(connection, row), MapState())


def reduced_session() -> Json:
    """Return a session with exact beams and reduced borders."""
    mapping = {"sensing": "exact", "tolerance": 0.05}
    return {"world": paper_world(), "sensor": {"beams": 36}, "mapping": mapping}


def test_reduced_borders_come_back_with_their_cores_and_go_on_from_there(
    connection: Connection,
) -> None:
    states = tuple(Twin.driven(reduced_session(), paper_steps()).states)
    found = store.load_state(connection, saved(connection, states[:41]))
    assert_same(found, states[40])
    for zone_id, one in found.metric.zones.items():
        other = states[40].metric.zones[zone_id]
        assert one.core is not None
        assert other.core is not None
        assert shapely.to_wkb(one.core.region) == shapely.to_wkb(other.core.region)
    twin = Twin(reduced_session(), states=[found])
    for document in paper_steps()[40:]:
        twin.step(document)
    assert_same(twin.states[-1], states[-1])


@pytest.mark.parametrize("seq", [1, 7, 31, 32, 33, 64, 65, 128, 139, 140])
def test_a_map_comes_back_as_it_was(connection: Connection, seq: int) -> None:
    row = saved(connection, long_run()[: seq + 1])
    assert_same(store.load_state(connection, row), long_run()[seq])


@pytest.mark.parametrize("seq", [0, 1, 31, 32, 33, 63, 64, 127, 128, 129, 140])
def test_the_checkpoint_before_a_step(connection: Connection, seq: int) -> None:
    row = saved(connection, long_run())
    found = store.load_checkpoint(connection, row, seq)
    assert found.seq == seq - seq % CHECKPOINT_EVERY
    assert_same(found, long_run()[found.seq])


@pytest.mark.parametrize("seq", [31, 32, 63, 64, 100, 128, 140])
def test_a_session_keeps_the_distance_of_its_checkpoints(connection: Connection, seq: int) -> None:
    with patch(CHECKPOINTS, 64):
        row = saved(connection, long_run())
    found = store.load_checkpoint(connection, row, seq)
    assert found.seq == seq - seq % 64
    assert_same(found, long_run()[found.seq])


def test_a_checkpoint_holds_only_what_changed(connection: Connection) -> None:
    row = saved(connection, long_run())
    for checkpoint in (32, 64, 96, 128):
        mine = (zone_versions.c.session == row.number, zone_versions.c.checkpoint == checkpoint)
        kept = set(connection.scalars(select(zone_versions.c.zone_id).where(*mine)))
        older, newer = long_run()[checkpoint - 32].metric, long_run()[checkpoint].metric
        assert kept == {zone.zone_id for zone in newer.changed_since(older)}


@settings(
    max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(scene=scenes(), chosen=options)
def test_any_map_comes_back(database: Database, scene: Scene, chosen: MappingOptions) -> None:
    taken = explore(scene.world, scene.sensor, scene.walk, chosen)
    states = (MapState(), *(step.state for step in taken))
    with database.writer.connect() as connection:
        row = saved(connection, states)
        assert_same(store.load_state(connection, row), states[-1])
        connection.rollback()


@settings(
    max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(scene=scenes(walk=7), chosen=all_options)
def test_any_map_comes_back_as_it_was_at_checkpoints(
    database: Database, scene: Scene, chosen: MappingOptions
) -> None:
    taken = explore(scene.world, scene.sensor, scene.walk, chosen)
    states = (MapState(), *(step.state for step in taken))
    with database.writer.connect() as connection, patch(CHECKPOINTS, 2):
        row = saved(connection, states)
        assert_same(store.load_state(connection, row), states[-1])
        for state in states:
            found = store.load_checkpoint(connection, row, state.seq)
            assert_same(found, states[state.seq - state.seq % 2])
        connection.rollback()


def test_sessions_do_not_mix(connection: Connection) -> None:
    one = saved(connection, long_run()[:70], "one")
    two = saved(connection, long_run()[:30], "two")
    assert_same(store.load_state(connection, one), long_run()[69])
    assert_same(store.load_state(connection, two), long_run()[29])
    assert_same(store.load_checkpoint(connection, two, 29), MapState())


def counts(connection: Connection) -> dict[str, int]:
    """Count the rows of every table that has to do with maps."""
    return {
        table.name: connection.scalars(select(func.count()).select_from(table)).one()
        for table in metadata.sorted_tables
        if table.name != "api_keys"
    }


def test_a_deletion_takes_everything_and_nothing_else(connection: Connection) -> None:
    stays = saved(connection, long_run()[:66], "stays")
    assert store.add_change(connection, stays.number, store.Change(1, 65, "", "zone", "{}"))
    before = counts(connection)
    assert all(count > 0 for count in before.values())
    goes = saved(connection, long_run()[:130], "goes")
    assert store.add_change(connection, goes.number, store.Change(1, 129, "", "zone", "{}"))
    assert all(count > before[name] for name, count in counts(connection).items())
    assert store.delete_session(connection, "goes")
    assert counts(connection) == before
    assert not store.delete_session(connection, "goes")
    assert store.find_session(connection, "goes") is None
    assert store.find_version(connection, "goes") is None


def test_a_number_is_never_used_again(connection: Connection) -> None:
    first = saved(connection, (MapState(),))
    store.delete_session(connection, "one")
    assert saved(connection, (MapState(),)).number > first.number


def test_only_who_knows_the_version_may_advance(connection: Connection) -> None:
    row = saved(connection, long_run()[:3])
    assert not store.advance(connection, row.number, 1)
    assert not store.advance(connection, row.number, 3)
    assert not store.advance(connection, row.number + 1, 0)
    assert store.find_version(connection, "one") == (row.number, 2, 0)
    assert store.advance(connection, row.number, 2)
    assert store.find_version(connection, "one") == (row.number, 3, 0)


def test_only_who_knows_the_session_may_change_it(connection: Connection) -> None:
    number = saved(connection, long_run()[:3]).number
    first, second = (store.Change(it, 2, f"time {it}", "zone", "{}") for it in (1, 2))
    assert not store.add_change(connection, number, second)
    assert not store.add_change(connection, number, store.Change(1, 1, "", "zone", "{}"))
    assert store.add_change(connection, number, first)
    assert not store.add_change(connection, number, first)
    assert store.add_change(connection, number, second)
    assert store.find_version(connection, "one") == (number, 2, 2)
    assert store.list_changes(connection, number) == [first, second]
    assert store.list_changes(connection, number, after=1) == [second]
    assert store.list_changes(connection, number, up_to=1) == []
    assert store.advance(connection, number, 2)
    assert store.find_version(connection, "one") == (number, 3, 2)


def test_the_log_is_found_by_number_and_key(connection: Connection) -> None:
    row = saved(connection, (MapState(),))
    other = saved(connection, (MapState(),), "two")
    for seq in range(1, 8):
        store.add_step(connection, row.number, logged(seq, f"k{seq}"))
    assert store.find_step(connection, row.number, 3) == logged(3, "k3")
    assert store.find_step_by_key(connection, row.number, "k3") == logged(3, "k3")
    assert store.find_step(connection, row.number, 8) is None
    assert store.find_step_by_key(connection, other.number, "k3") is None
    found = store.list_steps(connection, row.number, after=2, limit=3)
    assert list(found) == [logged(seq, f"k{seq}") for seq in (3, 4, 5)]
    assert list(store.list_steps(connection, other.number, after=0, limit=3)) == []


def test_many_sessions_are_listed_in_order(connection: Connection) -> None:
    ids = [f"s{number}" for number in range(3_000)]
    for session_id in ids:
        store.add_session(connection, new(session_id))
    found, after = [], 0
    while page := store.list_sessions(connection, None, after, 256):
        found += [row.id for row in page]
        after = page[-1].number
    assert found == ids


def test_a_listing_reads_no_worlds(connection: Connection) -> None:
    store.add_session(connection, new("s"))
    sent: list[str] = []

    def note(_connection: object, _cursor: object, sql: str, *_more: object) -> None:
        sent.append(sql)

    event.listen(connection, "before_cursor_execute", note)
    (listed,) = store.list_sessions(connection, None, 0, 10)
    assert (listed.id, listed.version) == ("s", 0)
    assert "SELECT" in sent[0]
    assert not any(re.search(r"world|sensor|mapping", sql) for sql in sent)


def test_a_page_of_the_log_has_a_bound_but_is_never_empty(connection: Connection) -> None:
    row = saved(connection, (MapState(),))
    half = "x" * (store.PAGE_CHARACTERS // 2 - 100)
    large = [half, half, half, 3 * half, "", ""]
    for seq, text in enumerate(large, start=1):
        store.add_step(connection, row.number, replace(logged(seq, f"k{seq}"), input=text))

    def page(after: int, limit: int = 1_000) -> tuple[list[int], bool]:
        steps, more = store.page_of_steps(connection, row.number, after, limit)
        return [one.seq for one in steps], more

    assert page(0) == ([1, 2], True)
    assert page(2) == ([3], True)
    assert page(3) == ([4], True)
    assert page(4) == ([5, 6], False)
    assert page(4, 1) == ([5], True)
    assert page(4, 2) == ([5, 6], False)
    assert page(6) == ([], False)


# What the schema refuses

ZONE = {
    "zone_id": "z", "position": 90, "label": "z", "since": 1, "seq": 1, "region": b"",
    "border": b"",
}  # fmt: skip
EDGE = {
    "source": "corridor", "target": "C", "number": 0, "position": 90, "x": 0.0, "y": 0.0,
    "seq": 1, "moved": 0,
}  # fmt: skip
DOOR = {
    "one": "A", "other": "corridor", "number": 1, "position": 90, "since": 1, "seq": 1,
    "region": b"",
}  # fmt: skip
DOOR_VERSION = {
    "one": "A", "other": "corridor", "number": 0, "checkpoint": 64, "seq": 1, "region": b"",
}  # fmt: skip
VERSION = {"zone_id": "A", "checkpoint": 64, "seq": 1, "region": b"", "border": b""}
STEP = {"seq": 99, "taken_at": "", "key": None, "fingerprint": b"", "input": "", "answer": ""}
SESSION = {
    "id": "two", "name": "", "created_at": "", "sensor": "", "mapping": "", "engine": "",
    "version": 0,
}  # fmt: skip


@pytest.mark.parametrize(
    ("table", "row"),
    [
        ("zones", ZONE | {"zone_id": "A"}),
        ("zones", ZONE | {"position": 0}),
        ("zones", ZONE | {"since": 0}),
        ("zones", ZONE | {"since": 2}),
        ("zones", ZONE | {"session": 10**6}),
        ("zones", ZONE | {"label": None}),
        ("zones", ZONE | {"region": None}),
        ("passages", EDGE | {"target": "A"}),
        ("passages", EDGE | {"position": 0}),
        ("passages", EDGE | {"target": "corridor"}),
        ("passages", EDGE | {"target": "nowhere"}),
        ("passages", EDGE | {"source": "nowhere"}),
        ("passages", EDGE | {"session": 10**6}),
        ("passages", EDGE | {"x": None}),
        ("doorways", DOOR | {"number": 0}),
        ("doorways", DOOR | {"position": 0}),
        ("doorways", DOOR | {"one": "nowhere"}),
        ("doorways", DOOR | {"other": "nowhere"}),
        ("doorways", DOOR | {"since": 2}),
        ("doorways", DOOR | {"region": None}),
        ("doorway_versions", DOOR_VERSION | {"number": 7}),
        ("doorway_versions", DOOR_VERSION | {"session": 10**6}),
        ("zone_versions", VERSION | {"zone_id": "nowhere"}),
        ("zone_versions", VERSION | {"session": 10**6}),
        ("steps", STEP | {"seq": 1}),
        ("steps", STEP | {"seq": 0}),
        ("steps", STEP | {"key": "taken"}),
        ("steps", STEP | {"session": 10**6}),
        ("sessions", SESSION | {"id": "one"}),
        ("sessions", SESSION | {"version": -1}),
        ("sessions", SESSION | {"id": None}),
    ],
)
def test_the_schema_refuses(connection: Connection, table: str, row: dict[str, object]) -> None:
    number = saved(connection, long_run()[:30]).number
    with_key = update(steps).where(steps.c.session == number, steps.c.seq == 5)
    connection.execute(with_key.values(key="taken"))
    owner = {} if table == "sessions" else {"session": number}
    with pytest.raises(IntegrityError):
        connection.execute(insert(metadata.tables[table]).values(**{**owner, **row}))


def test_the_schema_takes_what_is_possible(connection: Connection) -> None:
    number = saved(connection, long_run()[:30]).number
    rows = {
        zones: ZONE, passages: EDGE, zone_versions: VERSION, steps: STEP, doorways: DOOR,
        doorway_versions: DOOR_VERSION,
    }  # fmt: skip
    for table, row in rows.items():
        connection.execute(insert(table).values(session=number, **row))
    connection.execute(insert(sessions).values(**SESSION))


def test_sessions_are_listed_by_their_owner(connection: Connection) -> None:
    for name in ("ours", "theirs"):
        add_key(connection, name, "2026")
    for number, owner in enumerate([1, 2, None, 1]):
        store.add_session(connection, replace(new(f"s{number}"), owner=owner))
    listed = {
        owner: [row.id for row in store.list_sessions(connection, owner, 0, 10)]
        for owner in (None, 1, 2)
    }
    assert listed == {None: ["s0", "s1", "s2", "s3"], 1: ["s0", "s3"], 2: ["s1"]}
    with pytest.raises(IntegrityError):
        store.add_session(connection, replace(new("other"), owner=99))


def test_a_zone_with_passages_takes_them_along(connection: Connection) -> None:
    number = saved(connection, long_run()[:30]).number
    connection.execute(delete(zones).where(zones.c.session == number, zones.c.zone_id == "A"))
    ends = connection.execute(
        select(passages.c.source, passages.c.target).where(passages.c.session == number)
    )
    assert all("A" not in tuple(pair) for pair in ends)


def test_a_step_writes_only_what_it_changed(connection: Connection) -> None:
    """Standing still for a hundred steps, a map does not grow."""
    before = long_run()[32]
    row = saved(connection, long_run()[:33])
    held = counts(connection)
    for seq in range(33, 133):
        after = replace(before, seq=seq)
        assert store.advance(connection, row.number, before.seq)
        store.save_changes(connection, row, before, after)
        before = after
    assert counts(connection) == held


def test_a_database_stays_small(tmp_path: Path) -> None:
    """The log and the changed zones are kept, and not the whole map at every step."""
    opened = open_database(f"sqlite:///{tmp_path / 'semtopo.db'}")
    with opened.writer.begin() as connection:
        saved(connection, long_run())
    opened.close()
    whole = sum(len(zones_body(state)) for state in long_run())
    assert (tmp_path / "semtopo.db").stat().st_size < whole / 5
