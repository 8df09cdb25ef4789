"""Questions over HTTP: every kind as described, refusals, history, hostile text."""

from __future__ import annotations

import json
import random
from functools import cache
from typing import Any, get_args

import pytest
from pydantic import TypeAdapter

from semtopo.answers import Answer, answer
from semtopo.atlas import Atlas
from semtopo.codec import answer_document, to_json
from semtopo.errors import SemtopoError
from semtopo.mapper import MapState, explore
from semtopo.sensor import Sensor
from semtopo.types import Point
from service.schemas.problems import ProblemAnswer
from service.schemas.questions import QueryAnswer
from tests.sentences import REFUSED, UNDERSTOOD
from tests.servers import Server
from tests.service.twin import paper_session, paper_steps, paper_world
from tests.test_answers import KINDS
from tests.test_paper import world
from tests.test_reading import FRAMES, HOSTILE, TEXT_MAX

SEQ = 81
REPLY: TypeAdapter[Any] = TypeAdapter(QueryAnswer)


@pytest.fixture(scope="module")
def driven(lasting_server: Server) -> str:
    """Drive the paper's path, and give the session."""
    return paper_session(lasting_server)


@cache
def states() -> list[MapState]:
    path: list[Point] = [(it["pose"]["x"], it["pose"]["y"]) for it in paper_steps()]
    steps = explore(world(), Sensor(beams=72, range=2.0, samples=20), path)
    return [MapState(), *(step.state for step in steps)]


def library(text: str) -> Any:  # noqa: ANN401 -- JSON
    """Return what the library answers, or the code with which it refuses."""
    try:
        found = answer(Atlas(states()[SEQ]), text, states().__getitem__)
    except SemtopoError as refused:
        return refused.code
    return json.loads(to_json(answer_document(found)))


def asked(server: Server, path: str, text: str) -> Any:  # noqa: ANN401 -- JSON
    """Ask, hold the reply against its schema, and return it, or the code of the refusal."""
    reply = server.client.post(f"{path}/query", json={"text": text})
    if reply.status_code == 200:
        assert REPLY.validate_json(reply.content).sentence
        return reply.json()
    assert reply.status_code in {404, 409, 422}, reply.text
    problem = ProblemAnswer.model_validate_json(reply.content)
    assert set(reply.json()) <= set(ProblemAnswer.model_fields)
    assert problem.detail.endswith(".") or problem.detail.startswith("body.text")
    return problem.code


@pytest.mark.parametrize(("text", "kind"), KINDS)
def test_every_kind_is_answered_as_by_the_library(
    server: Server, driven: str, text: str, kind: type[Answer]
) -> None:
    reply = asked(server, driven, text)
    assert reply == library(text)
    assert reply["kind"] == kind.kind


def test_the_corpus_is_answered_as_by_the_library(server: Server, driven: str) -> None:
    texts = [text for text, *_ in UNDERSTOOD] + [text for text, *_ in REFUSED if text]
    codes = [asked(server, driven, text) for text in texts]
    assert codes == [library(text) for text in texts]
    refused = {code for code in codes if isinstance(code, str)}
    assert refused == {"crowded_question", "invalid_question", "unknown_zone"}
    assert sum(isinstance(code, dict) for code in codes) > 20


def test_a_robot_is_asked_for_by_its_radius(server: Server, driven: str) -> None:
    body = {"text": "path from A to C", "radius": 0.1, "two_way": True}
    reply = server.client.post(f"{driven}/query", json=body).json()
    REPLY.validate_python(reply)
    assert reply["sentence"].endswith("m long.")
    assert reply["route"]["path"]["clearance"] >= 0.1
    assert [leg["path"] for leg in reply["legs"]] == [reply["route"]["path"]]
    narrow = server.client.post(f"{driven}/query", json={**body, "radius": 5})
    assert (narrow.status_code, narrow.json()["code"]) == (409, "too_narrow")
    for wrong in ({"radius": -1}, {"radius": 1e9}, {"two_way": "yes"}):
        assert server.client.post(f"{driven}/query", json={**body, **wrong}).status_code == 422


def test_the_interface_describes_every_kind(server: Server) -> None:
    document = json.loads(server.get("/openapi.json"))
    operation = document["paths"]["/sessions/{session_id}/query"]["post"]
    schema = operation["responses"]["200"]["content"]["application/json"]["schema"]
    mapping = schema["discriminator"]["mapping"]
    assert list(mapping) == [kind.kind for kind in get_args(Answer)]
    for kind, reference in mapping.items():
        described = document["components"]["schemas"][reference.rsplit("/", 1)[1]]
        assert described["properties"]["kind"]["const"] == kind
        assert described["description"]
        assert {"kind", "sentence"} <= set(described["required"])


def test_refusals_tell_programs_why(server: Server, driven: str) -> None:
    def refused(text: str) -> Any:  # noqa: ANN401 -- JSON
        return server.client.post(f"{driven}/query", json={"text": text}).json()

    shape = refused("path from corridor")
    assert (shape["status"], shape["position"], shape["expected"]) == (422, 18, '"to"')
    assert shape["example"] == "path from corridor to C"
    name = refused("path from coridor to C")
    assert (name["status"], name["closest"], name["position"]) == (404, ["corridor"], 10)
    step = refused("what did I see at step 82")
    assert (step["status"], step["code"]) == (404, "unknown_step")


def test_a_session_that_grows(server: Server) -> None:
    """At step 29 the way to C is refused, with the reason; at step 66 it is answered."""
    path = server.create(world=paper_world())
    assert asked(server, path, "where am I") == "unknown_position"
    assert asked(server, path, "go to C") == "unknown_position"
    assert asked(server, path, "list zones")["zones"] == []
    for number, document in enumerate(paper_steps()[:66], start=1):
        server.step(path, document)
        if 29 <= number < 66 and number % 9 == 2:
            reply = server.client.post(f"{path}/query", json={"text": "path from corridor to C"})
            problem = reply.json()
            assert (reply.status_code, problem["code"]) == (409, "no_route")
            assert problem["missing"] == {"source": "corridor", "target": "C", "since": 29}
            assert "corridor -> C is not known" in problem["detail"]
            assert problem["reaching"] == ["C"]
            assert set(problem["frontier"]) == {"zone_id", "point", "towards", "distance"}
    assert asked(server, path, "path from corridor to C")["route"]["zones"] == ["corridor", "C"]
    seen = asked(server, path, "what did I see at step 29")
    assert (seen["zone"], seen["zones"], seen["position"]) == ("C", ["C"], [9.4, 4.1])
    changed = asked(server, path, "what changed between step 29 and 66")
    assert changed["zones"] == ["B"]


def test_hostile_text_harms_nobody(server: Server, driven: str) -> None:
    chance = random.Random(4)
    texts = [(frame, unit) for frame in FRAMES for unit in HOSTILE]
    for frame, unit in chance.sample(texts, 120):
        asked(server, driven, frame.format(unit * TEXT_MAX)[:TEXT_MAX])
    alphabet = "path from to via C corridor \"'“”,.?!\n\t\u0000\u202e🤖é厨"
    for _ in range(80):
        text = "".join(chance.choices(alphabet, k=chance.randint(1, TEXT_MAX)))
        asked(server, driven, text)
    assert server.faults() == []


def test_aliases_and_classes_are_asked_for_by_name(server: Server) -> None:
    path = server.create(world=paper_world())
    for document in paper_steps()[:45]:
        server.step(path, document)
    notes = {"aliases": ["the way out", "Küche"], "class": "office"}
    assert server.client.put(f"{path}/zones/A", json=notes).status_code == 200
    assert asked(server, path, "go to the way out")["route"]["target"] == "A"
    assert asked(server, path, "path from B to küche")["route"]["target"] == "A"
    assert asked(server, path, "nearest office from B")["zone"] == "A"
    assert [it["zone"] for it in asked(server, path, "list zones of class Office")["zones"]] == [
        "A"
    ]
    assert asked(server, path, "list classes")["classes"] == [
        {"zone_class": "office", "zones": ["A"]}
    ]
    listed = asked(server, path, "list zones")["zones"]
    assert {"zone": "A", "label": "A", "zone_class": "office", "aliases": notes["aliases"]} in (
        listed
    )


def test_what_is_closed_is_said_to_be(server: Server) -> None:
    path = server.create(world=paper_world())
    for document in paper_steps()[:45]:
        server.step(path, document)
    closing = {"passage": {"source": "corridor", "target": "A"}, "closed": True}
    made = server.client.post(f"{path}/restrictions", json=closing)
    assert made.status_code == 201, made.text
    reply = server.client.post(f"{path}/query", json={"text": "path from B to A"}).json()
    assert (reply["code"], reply["restricted"]) == ("no_route", True)
    assert "but for what is closed or avoided" in reply["detail"]
    assert asked(server, path, "is there a way from B to A")["connected"] is False
    assert asked(server, path, "which zones are reachable from B")["zones"] == ["corridor"]
