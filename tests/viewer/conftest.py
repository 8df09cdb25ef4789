"""One browser for all tests of the page, and servers that they look at."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser

from tests.servers import Server
from tests.viewer.browser import running_browser


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    """Give a browser that runs until the tests of a module have ended.

    No longer: as long as it runs, so does an event loop, and no other test could begin one.
    """
    with running_browser() as browser:
        yield browser


@pytest.fixture(scope="module")
def page_server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    """Give a server for the tests of a module, whose sessions fit on one page of the list."""
    server = Server(tmp_path_factory.mktemp("page"))
    server.start()
    yield server
    server.close()


@pytest.fixture
def server(page_server: Server) -> Iterator[Server]:
    """Give a running server. No test may make it log a traceback."""
    before = len(page_server.faults())
    yield page_server
    assert page_server.faults()[before:] == []


@pytest.fixture
def empty_server(tmp_path: Path) -> Iterator[Server]:
    """Give a running server without any session, which the test may stop."""
    server = Server(tmp_path / "empty")
    server.start()
    yield server
    server.close()
    assert server.faults() == []
