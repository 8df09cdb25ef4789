"""A few hundred requests drawn from the OpenAPI document; `make fuzz` sends many more."""

from __future__ import annotations

import pytest

from tests.fuzz import Fuzz
from tests.servers import Server


@pytest.mark.filterwarnings("ignore")
def test_what_is_drawn_is_answered_as_described(server: Server) -> None:
    tally = Fuzz(server).run(cases=300, seed=1)
    assert tally.faults == {}
    assert tally.server_errors == 0
    assert tally.cases > 200
    statuses = {status for _, status in tally.statuses}
    assert {200, 201, 204, 400, 404, 422} <= statuses
