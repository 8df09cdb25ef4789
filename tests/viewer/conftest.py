"""One browser for all tests of the page, and servers that they look at."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser

from tests.servers import Server
from tests.viewer.browser import running_browser


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    """Give a browser that runs until all tests of a process have ended."""
    with running_browser() as browser:
        yield browser


@pytest.fixture
def empty_server(tmp_path: Path) -> Iterator[Server]:
    """Give a running server without any session, which the test may stop."""
    server = Server(tmp_path / "empty")
    server.start()
    yield server
    server.close()
    assert server.faults() == []
