"""What all tests share: how hypothesis searches, and a running server."""

from __future__ import annotations

import os
from collections.abc import Iterator

import pytest
from hypothesis import settings

from tests.servers import Server

settings.register_profile("default", deadline=None)
settings.register_profile("ci", deadline=None, derandomize=True, print_blob=True)
settings.load_profile("ci" if os.environ.get("CI") else "default")


@pytest.fixture(scope="session")
def lasting_server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    """Give a server that runs until all tests have ended."""
    server = Server(tmp_path_factory.mktemp("server"))
    server.start()
    yield server
    server.close()


@pytest.fixture
def server(lasting_server: Server) -> Iterator[Server]:
    """Give a running server; sessions keep tests apart. No test may make it log a traceback."""
    before = len(lasting_server.faults())
    yield lasting_server
    assert lasting_server.faults()[before:] == []


@pytest.fixture
def own_server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    """Give a server, not yet started, that the test may kill."""
    server = Server(tmp_path_factory.mktemp("own"))
    yield server
    server.close()
    assert server.faults() == []
