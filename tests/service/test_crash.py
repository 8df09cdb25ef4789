"""Processes are killed at random while robots drive: no step is lost, doubled or out of order.

A few kills each; `make crash` does many more.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.crash import On, run
from tests.postgres import need_postgres

pytestmark = pytest.mark.slow


@pytest.mark.parametrize(
    ("on", "kills"),
    [
        (On.SQLITE, 20),
        (On.SQLITE_STOPPED, 3),
        (On.SQLITE_TWO, 2),
        (On.POSTGRES, 3),
        (On.POSTGRES_ITSELF, 4),
    ],
)
def test_nothing_goes_wrong(on: On, kills: int, tmp_path: Path) -> None:
    if on in {On.POSTGRES, On.POSTGRES_ITSELF}:
        need_postgres()
    report = run(on, kills, seed=kills, folder=tmp_path)
    assert report.answered > 100
    assert report.replayed_after_hanging_up > 0
    if on is On.SQLITE:  # in flight when it was killed: without keys, each would count twice
        assert report.replayed > 0
