"""Zones as instances and passages by doorway, over HTTP: after restarts, and as of any step."""

from __future__ import annotations

import json

import pytest

from semtopo.exports.geojson import doorways_body
from service.schemas import notes as schemas
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


def test_what_was_noted_follows(own_server: Server) -> None:
    """Names and restrictions on a zone that becomes part of another are on that one from then."""
    own_server.start()
    path = own_server.create(**SESSION)
    for document in WALK[:3]:
        own_server.step(path, document)
    noted = own_server.client.put(
        f"{path}/zones/o-2", json={"aliases": ["the nook"], "class": "den"}
    )
    assert noted.status_code == 200
    zone = restricted(own_server, path, {"zone": "o-2", "factor": 2})
    entry = {"passage": {"source": "h", "target": "o-2"}}
    door = restricted(own_server, path, {**entry, "closed": True})
    before = {what: own_server.get(f"{path}/{what}") for what in ("graph", "restrictions")}
    own_server.step(path, WALK[3])

    def check() -> None:
        for what, body in before.items():
            assert own_server.get(f"{path}/{what}", at=3) == body
        nodes = json.loads(own_server.get(f"{path}/graph"))["nodes"]
        assert nodes[1] == {
            "id": "o", "label": "o", "aliases": ["the nook"], "class": "den", "factor": 2.0,
        }  # fmt: skip
        listed = json.loads(own_server.get(f"{path}/restrictions"))["restrictions"]
        assert listed == [
            {**zone, "zone": "o", "was": {"zone": "o-2"}},
            {**door, "passage": {"source": "h", "target": "o", "n": 1}, "was": entry},
        ]
        for one in listed:
            schemas.RestrictionAnswer.model_validate(one)
        for name in ("THE nook", "den", "o-2"):
            found = own_server.client.get(f"{path}/route", params={"from": "h", "to": name})
            assert [it.get("n", 0) for it in found.json()["passages"]] == [0]

    check()
    own_server.restart()
    check()
    taken = own_server.client.put(f"{path}/zones/h", json={"aliases": ["the nook"]})
    assert (taken.status_code, taken.json()["code"]) == (409, "name_taken")
    again = restricted(own_server, path, {"zone": "o", "factor": 3})
    assert again == {**zone, "zone": "o", "factor": 3.0, "since": 4}
    assert own_server.client.put(f"{path}/zones/o", json={"aliases": ["study"]}).status_code == 200
    own_server.restart()
    nodes = json.loads(own_server.get(f"{path}/graph"))["nodes"]
    assert nodes[1] == {"id": "o", "label": "o", "aliases": ["study"], "factor": 3.0}
    listed = json.loads(own_server.get(f"{path}/restrictions"))["restrictions"]
    assert [one["id"] for one in listed] == [again["id"], door["id"]]


def test_of_two_restrictions_on_zones_that_become_one_a_new_one_takes_the_place(
    own_server: Server,
) -> None:
    own_server.start()
    path = own_server.create(**SESSION)
    for document in WALK[:3]:
        own_server.step(path, document)
    first = restricted(own_server, path, {"zone": "o", "factor": 2})
    restricted(own_server, path, {"zone": "o-2", "factor": 5})
    own_server.step(path, WALK[3])
    nodes = json.loads(own_server.get(f"{path}/graph"))["nodes"]
    assert nodes[1]["factor"] == 10
    new = restricted(own_server, path, {"zone": "o", "closed": True})
    assert new["id"] == first["id"]
    own_server.restart()
    assert json.loads(own_server.get(f"{path}/restrictions"))["restrictions"] == [new]


def restricted(server: Server, path: str, body: Json) -> Json:
    """Restrict something; return the answer."""
    answer = server.client.post(f"{path}/restrictions", json=body)
    assert answer.status_code in {200, 201}
    made: Json = answer.json()
    return made


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
