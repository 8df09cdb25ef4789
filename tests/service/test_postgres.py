"""What only PostgreSQL can do to a service: hold rows, cut connections, vanish and come back."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager

import pytest
from sqlalchemy import Connection, create_engine, make_url, select, text

from service.tables import sessions
from tests.postgres import running_postgres
from tests.servers import Json, Server
from tests.service.twin import paper_steps, paper_world

pytestmark = pytest.mark.databases("postgres")

SESSION: Json = {"world": paper_world(), "sensor": {"beams": 36}}
STEPS = paper_steps()


@contextmanager
def connected(url: str) -> Iterator[Connection]:
    """Give a connection of our own, to see and to disturb what the service does."""
    engine = create_engine(make_url(url).set(drivername="postgresql+psycopg"))
    with engine.connect() as connection:
        yield connection
    engine.dispose()


def test_who_holds_a_session_up_holds_up_no_other(own_server: Server) -> None:
    """A process that stands still in a transaction: 503 after a while, and no harm done."""
    own_server.start()
    path, other = own_server.create(**SESSION), own_server.create(**SESSION)
    mine = select(sessions).where(sessions.c.id == path.rpartition("/")[2])
    with connected(own_server.url) as connection, ThreadPoolExecutor() as threads:
        connection.execute(mine.with_for_update())
        held = threads.submit(own_server.client.post, f"{path}/step", json=STEPS[0])
        for document in STEPS[:5]:
            own_server.step(other, document)
        assert not held.done()
        answer = held.result()
        assert (answer.status_code, answer.headers["Retry-After"]) == (503, "1")
        assert answer.json()["code"] == "storage_unavailable"
    assert own_server.step(path, STEPS[0])["seq"] == 1


def test_connections_that_were_cut_are_replaced(own_server: Server) -> None:
    """The robot does not notice: a connection is tried before it is used."""
    own_server.start()
    path = own_server.create(**SESSION)
    mine = text(
        "SELECT pg_terminate_backend(pid) FROM pg_stat_activity"
        " WHERE datname = current_database() AND pid <> pg_backend_pid()"
    )
    with connected(own_server.url) as connection:
        for seq in range(1, 11):
            assert own_server.step(path, {**STEPS[seq], "seq": seq})["seq"] == seq
            assert own_server.get(f"{path}/zones")
            assert connection.execute(mine).all()
            connection.commit()


def test_a_database_that_is_away_for_a_while(tmp_path_factory: pytest.TempPathFactory) -> None:
    """Everything that needs it is answered 503, and goes on by itself when it is back."""
    with running_postgres() as postgres:
        server = Server(tmp_path_factory.mktemp("away"), postgres.create("away"))
        server.start()
        try:
            path = server.create(**SESSION)
            first = server.step(path, {**STEPS[0], "seq": 1})
            postgres.kill()
            for method, below, body in (
                ("POST", "/step", STEPS[1]), ("GET", "/graph", None), ("GET", "/zones?at=1", None),
                ("GET", "", None), ("GET", "/steps", None), ("DELETE", "", None),
            ):  # fmt: skip
                answer = server.client.request(method, path + below, json=body)
                assert (answer.status_code, answer.headers["Retry-After"]) == (503, "1"), below
                assert answer.json()["code"] == "storage_unavailable"
            assert server.client.get("/readyz").status_code == 503
            assert server.client.get("/healthz").status_code == 200
            postgres.start()
            assert server.step(path, {**STEPS[0], "seq": 1}) == first
            assert server.step(path, {**STEPS[1], "seq": 2})["seq"] == 2
            assert server.client.get("/readyz").status_code == 200
            assert server.faults() == []
        finally:
            server.close()
