"""What all tests share: how hypothesis searches, databases, and servers that run on them.

Modules marked `databases("sqlite", "postgres")` run on both, those without a mark on SQLite.
"""

from __future__ import annotations

import os
import secrets
from collections.abc import Callable, Iterator

import pytest
from hypothesis import settings

from tests.postgres import Postgres, need_postgres, running_postgres
from tests.servers import Backend, Server

settings.register_profile("default", deadline=None)
settings.register_profile("ci", deadline=None, derandomize=True, print_blob=True)
settings.load_profile("ci" if os.environ.get("CI") else "default")


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """Run a test on each database that its module names."""
    if "backend" in metafunc.fixturenames:
        mark = metafunc.definition.get_closest_marker("databases")
        names = ("sqlite",) if mark is None else mark.args
        ids = None if len(names) > 1 else [pytest.HIDDEN_PARAM]
        metafunc.parametrize("backend", names, indirect=True, ids=ids, scope="session")


@pytest.fixture(scope="session")
def backend(request: pytest.FixtureRequest) -> Backend:
    """Say which database to use."""
    name: Backend = request.param
    return name


@pytest.fixture(scope="session")
def postgres() -> Iterator[Postgres]:
    """Give a PostgreSQL of our own that runs until all tests have ended."""
    need_postgres()
    with running_postgres() as server:
        yield server


@pytest.fixture(scope="session")
def new_database(
    backend: Backend, request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> Callable[[], str]:
    """Give what makes the URL of a database that is empty, or not there yet."""
    if backend == "sqlite":
        return lambda: f"sqlite:///{tmp_path_factory.mktemp('database') / 'semtopo.db'}"
    postgres: Postgres = request.getfixturevalue("postgres")
    return lambda: postgres.create(f"test_{secrets.token_hex(8)}")


@pytest.fixture(scope="session")
def sqlite_server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    """Give a server on SQLite that runs until all tests have ended."""
    server = Server(tmp_path_factory.mktemp("server"))
    server.start()
    yield server
    server.close()


@pytest.fixture(scope="session")
def postgres_server(
    postgres: Postgres, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[Server]:
    """Give a server on PostgreSQL that runs until all tests have ended."""
    server = Server(tmp_path_factory.mktemp("server"), postgres.create("lasting"))
    server.start()
    yield server
    server.close()


@pytest.fixture(scope="session")
def lasting_server(backend: Backend, request: pytest.FixtureRequest) -> Server:
    """Give a server that runs until all tests have ended."""
    server: Server = request.getfixturevalue(f"{backend}_server")
    return server


@pytest.fixture
def server(lasting_server: Server) -> Iterator[Server]:
    """Give a running server; sessions keep tests apart. No test may make it log a traceback."""
    before = len(lasting_server.faults())
    yield lasting_server
    assert lasting_server.faults()[before:] == []


@pytest.fixture
def own_server(
    new_database: Callable[[], str], tmp_path_factory: pytest.TempPathFactory
) -> Iterator[Server]:
    """Give a server, not yet started, that the test may kill."""
    server = Server(tmp_path_factory.mktemp("own"), new_database())
    yield server
    server.close()
    assert server.faults() == []
