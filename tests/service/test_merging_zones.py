"""Zones as instances and passages by doorway, over HTTP: after restarts, and as of any step."""

from __future__ import annotations

import json

import pytest

from semtopo.exports.geojson import doorways_body
from tests.plans import drawn
from tests.servers import Json, Server
from tests.service.twin import Twin, at, untimed, world_json
from tests.test_instances import ROUND_A_PILLAR

pytestmark = pytest.mark.databases("sqlite", "postgres")

SESSION: Json = {
    "world": world_json(drawn(ROUND_A_PILLAR)),
    "sensor": {"beams": 180, "range": 6.0, "samples": 60},
    "mapping": {"edges": "adjacent", "passages": "all", "identity": "instance"},
}
WALK = [at(1.5, 1.7), at(9.5, 1.7), at(5.5, 1.7), at(5.5, 4.0), at(9.5, 4.0), at(1.5, 1.7)]
MERGE = {"type": "merge", "zone_id": "o-2", "into": "o"}


def check_alike(server: Server, path: str, twin: Twin) -> None:
    """Compare graph, zones and doorways of the service with those of the library, at each step."""
    for seq, state in enumerate(twin.states):
        assert server.get(f"{path}/graph", at=seq) == twin.graph(seq)
        assert server.get(f"{path}/zones", at=seq) == twin.zones(seq)
        assert server.get(f"{path}/doorways", at=seq) == doorways_body(state)


@pytest.mark.parametrize("restarted_after", [2, 4])
def test_two_rooms_become_one(own_server: Server, restarted_after: int) -> None:
    own_server.start()
    path, twin = own_server.create(**SESSION), Twin(SESSION)
    for number, document in enumerate(WALK, start=1):
        answer = own_server.step(path, document)
        assert untimed(answer) == twin.step(document)
        if number == restarted_after:
            own_server.restart()
    answers = twin.answers
    assert [one["zone_id"] for one in answers] == ["h", "h", "h", "o", "o", "h"]
    assert [one["here"] for one in answers] == ["h", "h", "h", "o", "o", "h"]
    assert MERGE in answers[3]["events"]
    check_alike(own_server, path, twin)
    nodes = [node["id"] for node in json.loads(own_server.get(f"{path}/graph", at=3))["nodes"]]
    assert nodes == ["h", "o", "o-2"]
    edges = json.loads(own_server.get(f"{path}/graph"))["edges"]
    assert {(edge["source"], edge["target"], edge.get("n", 0)) for edge in edges} == {
        ("h", "o", 0), ("h", "o", 1), ("o", "h", 1),
    }  # fmt: skip


def test_a_retry_gets_the_merge_again(own_server: Server) -> None:
    own_server.start()
    path = own_server.create(**SESSION)
    answers = [
        own_server.step(path, {**document, "seq": number})
        for number, document in enumerate(WALK[:4], start=1)
    ]
    assert MERGE in answers[-1]["events"]
    before = own_server.get(f"{path}/graph")
    assert own_server.step(path, {**WALK[3], "seq": 4}) == answers[-1]
    assert own_server.get(f"{path}/graph") == before


def test_a_long_drive_is_read_back_from_checkpoints(own_server: Server) -> None:
    """The merge comes after the first checkpoint, and there are more after it."""
    own_server.start()
    path, twin = own_server.create(**SESSION), Twin(SESSION)
    for document in [*(WALK[:3] * 23), *(WALK[3:] * 22)]:
        assert untimed(own_server.step(path, document)) == twin.step(document)
    own_server.restart()
    for seq in (63, 64, 65, 69, 70, 71, 127, 128, 130, 135):
        assert own_server.get(f"{path}/graph", at=seq) == twin.graph(seq)
        assert own_server.get(f"{path}/zones", at=seq) == twin.zones(seq)
        assert own_server.get(f"{path}/doorways", at=seq) == doorways_body(twin.states[seq])
