"""Names of zones and restrictions over HTTP: stored, shown, part of the history, and bounded."""

from __future__ import annotations

import json
import time
from typing import Any
from urllib.parse import quote

import httpx2
import pytest

from service.schemas import notes as schemas
from tests.servers import Server
from tests.service.twin import Twin, paper_steps, paper_world

pytestmark = pytest.mark.databases("sqlite", "postgres")

SESSION = {"world": paper_world(), "sensor": {"beams": 36}}
STEPS = paper_steps()
CORRIDOR_TO_A = {"passage": {"source": "corridor", "target": "A"}}


@pytest.fixture(scope="module")
def mapped(lasting_server: Server) -> str:
    """Give a session that nobody notes anything about, after step 8."""
    return driven(lasting_server, 8)


@pytest.fixture
def path(server: Server) -> str:
    """Give a session of one's own, after step 8: the corridor, A, and passages both ways."""
    return driven(server, 8)


def driven(server: Server, steps: int) -> str:
    path = server.create(**SESSION)
    for document in STEPS[:steps]:
        server.step(path, document)
    return path


def put(server: Server, path: str, zone_id: str, **names: Any) -> httpx2.Response:  # noqa: ANN401 -- JSON
    return server.client.put(f"{path}/zones/{quote(zone_id, safe='')}", json=names)


def restrict(server: Server, path: str, **body: Any) -> httpx2.Response:  # noqa: ANN401 -- JSON
    return server.client.post(f"{path}/restrictions", json=body)


def route(server: Server, path: str, **asked: Any) -> httpx2.Response:  # noqa: ANN401 -- parameters
    asked = {key.rstrip("_"): it for key, it in asked.items()}
    return server.client.get(f"{path}/route", params=asked)


def code(answer: httpx2.Response) -> tuple[int, str]:
    assert answer.headers["Content-Type"] == "application/problem+json"
    return answer.status_code, answer.json()["code"]


def properties(server: Server, path: str, zone_id: str, **query: object) -> dict[str, Any]:
    features = json.loads(server.get(f"{path}/zones", **query))["features"]
    found: dict[str, Any] = next(it for it in features if it["id"] == zone_id)["properties"]
    return found


class TestNames:
    def test_they_are_shown_and_understood(self, server: Server, path: str) -> None:
        answer = put(server, path, "A", aliases=["Anna's room", "R 1/2"], **{"class": "office"})
        assert answer.status_code == 200
        schemas.ZoneNotesAnswer.model_validate(answer.json())
        assert answer.json() == {
            "id": "A", "label": "A", "aliases": ["Anna's room", "R 1/2"], "class": "office",
        }  # fmt: skip
        assert properties(server, path, "A")["aliases"] == ["Anna's room", "R 1/2"]
        assert properties(server, path, "A")["class"] == "office"
        assert {"aliases", "class"}.isdisjoint(properties(server, path, "corridor"))
        nodes = json.loads(server.get(f"{path}/graph"))["nodes"]
        assert nodes[1] == answer.json()
        for name in ("anna's room", "r 1/2", "OFFICE"):
            assert route(server, path, from_="corridor", to=name).json()["target"] == "A"
        asked = {"text": "path from corridor to anna's room"}
        assert server.client.post(f"{path}/query", json=asked).json()["route"]["target"] == "A"

    def test_what_is_noted_replaces_what_was(self, server: Server, path: str) -> None:
        put(server, path, "A", aliases=["one"], **{"class": "office"})
        put(server, path, "A", aliases=["two"])
        assert properties(server, path, "A")["aliases"] == ["two"]
        assert "class" not in properties(server, path, "A")
        put(server, path, "A")
        assert "aliases" not in properties(server, path, "A")
        assert route(server, path, from_="corridor", to="two").status_code == 404

    def test_the_same_again_changes_nothing(self, server: Server, path: str) -> None:
        before = server.client.get(f"{path}/zones").headers["ETag"]
        answers = [put(server, path, "A", aliases=["one", "one"]) for _ in range(3)]
        assert len({answer.content for answer in answers}) == 1
        after = server.client.get(f"{path}/zones").headers["ETag"]
        assert (after != before, after) == (True, f'{before[:-1]}-1"')

    @pytest.mark.parametrize("alias", ["corridor", "CORRIDOR", "Hall", "hall"])
    def test_a_name_that_another_zone_has(self, server: Server, path: str, alias: str) -> None:
        put(server, path, "corridor", aliases=["Hall"])
        assert code(put(server, path, "A", aliases=[alias])) == (409, "name_taken")
        assert put(server, path, "corridor", aliases=[alias]).status_code == 200

    def test_a_zone_that_is_not_there(self, server: Server, mapped: str) -> None:
        answer = put(server, mapped, "corridro", aliases=["x"])
        assert code(answer) == (404, "unknown_zone")
        assert answer.json()["closest"] == ["corridor"]

    @pytest.mark.parametrize(
        "names",
        [
            {"aliases": [""]}, {"aliases": [" a"]}, {"aliases": ["a\x00"]}, {"aliases": "a"},
            {"aliases": ["x" * 101]}, {"aliases": [f"{it}" for it in range(11)]}, {"class": ""},
            {"class": 1}, {"aliases": None}, {"zone_class": 3}, {"else": 1},
        ],
    )  # fmt: skip
    def test_names_that_cannot_be(self, server: Server, mapped: str, names: dict[str, Any]) -> None:
        assert code(put(server, mapped, "A", **names)) == (422, "invalid_request")

    def test_any_label_may_be_in_the_address(self, server: Server) -> None:
        for label in ("a/b", "50 %", "ä?#&+", ".", "..", "zones/x", "厨房"):
            world = {"zones": [{"label": label, "kind": "space", "low": [0, 0], "high": [4, 4]}]}
            path = server.create(world=world)
            server.step(path, {"pose": {"x": 2, "y": 2}})
            if label not in {".", ".."}:  # clients take those for steps in the path
                assert put(server, path, label, aliases=["x"]).json()["id"] == label
                assert properties(server, path, label)["aliases"] == ["x"]


class TestRestrictions:
    def test_closing_and_opening(self, server: Server, path: str) -> None:
        plain = server.get(f"{path}/graph")
        made = restrict(server, path, **CORRIDOR_TO_A, closed=True)
        assert made.status_code == 201
        schemas.RestrictionAnswer.model_validate(made.json())
        assert made.json() == {
            "id": made.json()["id"], **CORRIDOR_TO_A, "closed": True, "factor": 1.0,
            "expires_at": None, "since": 8,
        }  # fmt: skip
        listed = json.loads(server.get(f"{path}/restrictions"))
        schemas.RestrictionsAnswer.model_validate(listed)
        assert listed == {"seq": 8, "restrictions": [made.json()]}
        refused = route(server, path, from_="corridor", to="A")
        assert code(refused) == (409, "no_route")
        assert refused.json()["restricted"] is True
        edges = json.loads(server.get(f"{path}/graph"))["edges"]
        assert [edge.get("closed") for edge in edges] == [True, None]
        assert server.client.delete(f"{path}/restrictions/{made.json()['id']}").status_code == 204
        assert server.get(f"{path}/graph") == plain
        assert route(server, path, from_="corridor", to="A").status_code == 200
        again = server.client.delete(f"{path}/restrictions/{made.json()['id']}")
        assert code(again) == (404, "unknown_restriction")

    def test_one_thing_has_one_restriction(self, server: Server, path: str) -> None:
        first = restrict(server, path, **CORRIDOR_TO_A, closed=True)
        tag = server.client.get(f"{path}/graph").headers["ETag"]
        again = restrict(server, path, **CORRIDOR_TO_A, closed=True)
        assert (again.status_code, again.json()) == (200, first.json())
        assert server.client.get(f"{path}/graph").headers["ETag"] == tag
        other = restrict(server, path, **CORRIDOR_TO_A, factor=3)
        assert (other.status_code, other.json()["id"]) == (200, first.json()["id"])
        assert json.loads(server.get(f"{path}/restrictions"))["restrictions"] == [other.json()]
        found = route(server, path, from_="corridor", to="A").json()
        assert found["cost"] > found["length"]

    @pytest.mark.parametrize("on", [{"zone": "a"}, {"label": "A"}])
    def test_zones_and_labels(self, server: Server, path: str, on: dict[str, str]) -> None:
        restrict(server, path, **on, closed=True, factor=2.5)
        assert code(route(server, path, from_="corridor", to="A")) == (409, "no_route")
        nodes = json.loads(server.get(f"{path}/graph"))["nodes"]
        assert nodes[1] == {"id": "A", "label": "A", "closed": True, "factor": 2.5}

    def test_it_ends_by_itself(self, server: Server, path: str) -> None:
        tags = [server.client.get(f"{path}/graph").headers["ETag"]]
        made = restrict(server, path, zone="A", closed=True, expires_in=1.0)
        until = time.monotonic() + 1.0
        tags.append(server.client.get(f"{path}/graph").headers["ETag"])
        assert route(server, path, from_="corridor", to="A").status_code == 409
        assert made.json()["expires_at"] is not None
        time.sleep(max(until - time.monotonic(), 0) + 0.05)
        assert route(server, path, from_="corridor", to="A").status_code == 200
        tags.append(server.client.get(f"{path}/graph").headers["ETag"])
        assert len(set(tags)) == 3
        assert json.loads(server.get(f"{path}/restrictions"))["restrictions"] == []
        assert "closed" not in json.loads(server.get(f"{path}/graph"))["nodes"][1]
        gone = server.client.delete(f"{path}/restrictions/{made.json()['id']}")
        assert code(gone) == (404, "unknown_restriction")
        assert restrict(server, path, zone="A", closed=True).status_code == 201

    @pytest.mark.parametrize(
        ("body", "problem"),
        [
            ({}, (422, "invalid_restriction")),
            ({"zone": "A"}, (422, "invalid_restriction")),
            ({"zone": "A", "factor": 1}, (422, "invalid_restriction")),
            ({"zone": "A", "label": "A", "closed": True}, (422, "invalid_restriction")),
            ({"zone": "A", "factor": 0}, (422, "invalid_restriction")),
            ({"zone": "A", "factor": 1e9}, (422, "invalid_restriction")),
            ({"zone": "A", "factor": "2"}, (422, "invalid_request")),
            ({"zone": "A", "closed": 1}, (422, "invalid_request")),
            ({"zone": "A", "closed": True, "expires_in": 0}, (422, "invalid_request")),
            ({"zone": "A", "closed": True, "expires_in": 1e10}, (422, "invalid_request")),
            ({"zone": "Z", "closed": True}, (404, "unknown_zone")),
            ({"label": "Z", "closed": True}, (404, "unknown_zone")),
            ({**CORRIDOR_TO_A, "n": 1, "closed": True}, (422, "invalid_request")),
            (
                {"passage": {"source": "corridor", "target": "corridor"}, "closed": True},
                (404, "unknown_passage"),
            ),
            (
                {"passage": {"source": "corridor", "target": "A", "n": 7}, "closed": True},
                (404, "unknown_passage"),
            ),
        ],
    )
    def test_what_cannot_be_restricted(
        self, server: Server, mapped: str, body: dict[str, Any], problem: tuple[int, str]
    ) -> None:
        assert code(restrict(server, mapped, **body)) == problem
        assert json.loads(server.get(f"{mapped}/restrictions"))["restrictions"] == []

    def test_an_id_that_is_none(self, server: Server, mapped: str) -> None:
        for name in ("0" * 16, "x"):
            answer = server.client.delete(f"{mapped}/restrictions/{name}")
            assert code(answer) in {(404, "unknown_restriction"), (422, "invalid_request")}


class TestHistory:
    def test_each_change_belongs_to_its_step(self, server: Server) -> None:
        path = driven(server, 7)
        put(server, path, "A", aliases=["seven"])
        restrict(server, path, **CORRIDOR_TO_A, closed=True)
        server.step(path, STEPS[7])
        put(server, path, "A", aliases=["eight"])
        server.step(path, STEPS[8])
        assert "aliases" not in properties(server, path, "A", at=6)
        assert properties(server, path, "A", at=7)["aliases"] == ["seven"]
        assert properties(server, path, "A", at=8)["aliases"] == ["eight"]
        assert properties(server, path, "A", at=9) == properties(server, path, "A")
        assert route(server, path, from_="corridor", to="A", at=6).status_code == 200
        assert route(server, path, from_="corridor", to="A", at=7).status_code == 409
        assert route(server, path, from_="corridor", to="A", at=99).status_code == 404
        assert json.loads(server.get(f"{path}/restrictions", at=6)) == {
            "seq": 6, "restrictions": [],
        }  # fmt: skip
        assert len(json.loads(server.get(f"{path}/restrictions", at=7))["restrictions"]) == 1

    def test_without_notes_everything_is_as_it_was(self, server: Server, mapped: str) -> None:
        twin = Twin.driven(SESSION, STEPS[:8])
        assert server.get(f"{mapped}/zones") == twin.zones()
        assert server.get(f"{mapped}/graph") == twin.graph()
        tag = server.client.get(f"{mapped}/zones").headers["ETag"]
        assert tag.count("-") == 1

    def test_notes_survive_a_crash(self, own_server: Server) -> None:
        own_server.start()
        path = driven(own_server, 8)
        put(own_server, path, "A", aliases=["x"], **{"class": "office"})
        restrict(own_server, path, **CORRIDOR_TO_A, factor=2, expires_in=600)
        own_server.step(path, STEPS[8])
        shown = [own_server.client.get(path + it) for it in ("/zones", "/graph", "/restrictions")]
        own_server.restart()
        for before, below in zip(shown, ("/zones", "/graph", "/restrictions"), strict=True):
            after = own_server.client.get(path + below)
            assert after.content == before.content
            assert after.headers.get("ETag") == before.headers.get("ETag")
        assert route(own_server, path, from_="corridor", to="x").status_code == 200

    def test_steps_do_not_mind(self, server: Server, path: str) -> None:
        """A step with the tag of a map that was renamed since is taken; notes are no steps."""
        tag = server.client.get(f"{path}/zones").headers["ETag"]
        put(server, path, "A", aliases=["x"])
        renamed = server.client.get(f"{path}/zones").headers["ETag"]
        server.step(path, STEPS[8], {"If-Match": tag})
        refused = server.client.post(f"{path}/step", json=STEPS[9], headers={"If-Match": renamed})
        assert code(refused) == (412, "version_mismatch")
        put(server, path, "A", aliases=["y"])
        now = server.client.get(f"{path}/zones").headers["ETag"]
        put(server, path, "A", aliases=["z"])
        server.step(path, STEPS[9], {"If-Match": now})
