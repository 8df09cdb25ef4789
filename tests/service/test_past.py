"""Earlier maps: those of the run itself, wherever the replay that leads to them begins."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from unittest.mock import patch

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sqlalchemy import Connection

from semtopo.codec import to_json
from semtopo.mapper import MapState
from service import store
from service.database import Database, open_database
from service.errors import UnknownSessionError
from service.history import look_again
from service.hot import HotSession, load
from service.past import KEPT_EVERY, Past
from service.settings import Settings
from service.store import CHECKPOINT_EVERY
from tests.service.test_store import STEPS, assert_same, long_run, saved
from tests.service.twin import paper_world

pytestmark = pytest.mark.databases("sqlite", "postgres")


@pytest.fixture(scope="module")
def database(new_database: Callable[[], str]) -> Iterator[Database]:
    """Give a database with the paper's run, there and part of the way back."""
    opened = open_database(new_database())
    world, sensor = to_json(paper_world()).decode(), to_json({"beams": 36}).decode()
    with opened.writer.begin() as connection:
        saved(connection, long_run(), world=world, sensor=sensor)
    yield opened
    opened.close()


@pytest.fixture(scope="module")
def hot(database: Database) -> HotSession:
    """Give the session in memory."""
    with database.reader.begin() as connection:
        return load(connection, "one", None)


class Counted(Past):
    """An earlier maps' keeper that counts how often it reads."""

    def __init__(self, database: Database, past_maps_max: int = 1_024) -> None:
        """Begin with nothing in memory."""
        self.reads = 0

        def read(query: Callable[[Connection], MapState]) -> MapState:
            self.reads += 1
            with database.reader.begin() as connection:
                return query(connection)

        super().__init__(read, Settings(past_maps_max=past_maps_max))


def test_every_earlier_map_is_that_of_the_run(database: Database, hot: HotSession) -> None:
    past = Counted(database)
    for seq in range(STEPS + 1):
        assert_same(past.state_at(hot, seq), long_run()[seq])


@settings(max_examples=25, deadline=None)
@given(asked=st.lists(st.integers(0, STEPS), min_size=2, max_size=8), kept=st.integers(1, 5))
def test_in_any_order_and_with_little_memory(
    database: Database, hot: HotSession, asked: list[int], kept: int
) -> None:
    past = Counted(database, past_maps_max=kept)
    for seq in [*asked, asked[0]]:
        assert_same(past.state_at(hot, seq), long_run()[seq])


def test_a_map_that_was_asked_for_is_at_hand(database: Database, hot: HotSession) -> None:
    past = Counted(database)
    first = past.state_at(hot, 61)
    assert past.reads == 1
    assert past.state_at(hot, 61) is first
    assert past.reads == 1


def test_neighbours_are_a_few_steps_away(database: Database, hot: HotSession) -> None:
    """After one replay to the end of a stretch, each map is less than `KEPT_EVERY` steps away."""
    past = Counted(database)
    past.state_at(hot, 2 * CHECKPOINT_EVERY - 1)
    for seq in range(2 * CHECKPOINT_EVERY - 1, CHECKPOINT_EVERY - 1, -1):
        with patch("service.past.look_again", wraps=look_again) as looked:
            assert_same(past.state_at(hot, seq), long_run()[seq])
        assert looked.call_count < KEPT_EVERY


def test_who_asks_for_the_same_map_at_once_gets_one_replay(
    database: Database, hot: HotSession
) -> None:
    past = Counted(database)
    with ThreadPoolExecutor(8) as threads:
        found = list(threads.map(lambda seq: past.state_at(hot, seq), [63] * 8))
    assert past.reads == 1
    assert all(state is found[0] for state in found)
    assert_same(found[0], long_run()[63])


def test_a_map_that_became_full_has_a_past(database: Database, hot: HotSession) -> None:
    with patch("service.hot.MAP_BYTES_MAX", 1):
        assert_same(Counted(database).state_at(hot, 40), long_run()[40])


@pytest.mark.parametrize("seq", [32, 40])
def test_a_session_that_was_deleted_meanwhile_is_unknown(
    database: Database, hot: HotSession, seq: int
) -> None:
    with database.writer.connect() as connection:

        def read(query: Callable[[Connection], MapState]) -> MapState:
            return query(connection)

        store.delete_session(connection, "one")
        with pytest.raises(UnknownSessionError):
            Past(read, Settings()).state_at(hot, seq)
        connection.rollback()
