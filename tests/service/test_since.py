"""What changed since a step, over HTTP: added to what was known, it gives the map as it is now."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from typing import Any

import pytest

from semtopo.codec import graph_body, zones_body
from semtopo.exports.geojson import borders_body, doorways_body
from semtopo.mapper import MapState
from tests.servers import Json, Server
from tests.service.test_merging_zones import SESSION, WALK
from tests.service.twin import Twin, paper_steps, paper_world

pytestmark = pytest.mark.databases("sqlite", "postgres")

Body = Callable[[MapState, int | None], bytes]

BODIES: Mapping[str, Body] = {
    "zones": lambda state, since: zones_body(state, since=since),
    "graph": lambda state, since: graph_body(state.graph, state.seq, since=since),
    "borders": lambda state, since: borders_body(state, since=since),
    "doorways": lambda state, since: doorways_body(state, since=since),
}

RUNS: Mapping[str, tuple[Json, list[Json]]] = {
    "paper": ({"world": paper_world()}, paper_steps()),
    "merging": (SESSION, WALK),
}

each_body = pytest.mark.parametrize("view", BODIES)
each_run = pytest.mark.parametrize("run", RUNS)


@pytest.fixture(scope="module")
def twins() -> Mapping[str, Twin]:
    """Give the runs in the library."""
    return {run: Twin.driven(session, steps) for run, (session, steps) in RUNS.items()}


@pytest.fixture(scope="module")
def paths(lasting_server: Server) -> Mapping[str, str]:
    """Give the same runs on a server."""
    found = {}
    for run, (session, steps) in RUNS.items():
        found[run] = lasting_server.create(**session)
        for document in steps:
            lasting_server.step(found[run], document)
    return found


def parts(view: str, body: bytes) -> dict[str, dict[Any, Any]]:
    """Return what a body tells of, by what names it."""
    document = json.loads(body)
    if view == "graph":
        return {
            "nodes": {node["id"]: node for node in document["nodes"]},
            "edges": {(it["source"], it["target"], it.get("n", 0)): it for it in document["edges"]},
        }
    features = document["features"]
    if view == "zones":
        return {"": {it["id"]: it for it in features}}
    about = [it["properties"] for it in features]
    if view == "doorways":
        names = [(*it["ends"], it["number"]) for it in about]
        return {"": dict(zip(names, features, strict=True))}
    zones = {it["zone_id"] for it in about}
    of = {name: [it for it in features if it["properties"]["zone_id"] == name] for name in zones}
    return {"": of}


def totals(view: str, body: bytes) -> dict[str, int]:
    total = json.loads(body)["total"]
    return total if view == "graph" else {"": total}


@each_body
@each_run
def test_known_and_changed_is_all(twins: Mapping[str, Twin], run: str, view: str) -> None:
    """From any step to any later one; where some are gone, the total tells."""
    states = twins[run].states
    body = BODIES[view]
    gone = smaller = 0
    for later in states[:: 1 if run == "merging" else 7]:
        for before in states[: later.seq + 1 : 1 if run == "merging" else 5]:
            told = body(later, before.seq)
            whole, known = parts(view, body(later, None)), parts(view, body(before, None))
            news, total = parts(view, told), totals(view, told)
            for name, now in whole.items():
                assert total[name] == len(now)
                united = {**known[name], **news[name]}
                if known[name].keys() <= now.keys():
                    assert united == now
                else:
                    assert len(united) > total[name]
                    gone += 1
            smaller += len(told) < len(body(later, None)) / 2
    assert (gone > 0) == (run == "merging")
    assert smaller > 0


@each_body
@each_run
def test_it_is_that_of_the_library(
    server: Server, twins: Mapping[str, Twin], paths: Mapping[str, str], run: str, view: str
) -> None:
    states = twins[run].states
    last = states[-1].seq
    for since in {0, 1, 3, last - 1, last}:
        told = server.get(f"{paths[run]}/{view}", since=since)
        assert told == BODIES[view](states[-1], since)
    for since, at in ((0, 4), (3, 4), (4, 4), (2, last)):
        told = server.get(f"{paths[run]}/{view}", since=since, at=at)
        assert told == BODIES[view](states[at], since)
        assert told == server.get(f"{paths[run]}/{view}", since=since, at=at)  # from memory


@each_body
def test_a_step_that_is_still_to_come_is_unknown(
    server: Server, paths: Mapping[str, str], view: str
) -> None:
    path = paths["paper"]
    for query in ("since=82", "since=2147483647", "since=5&at=4"):
        refusal = server.client.get(f"{path}/{view}?{query}")
        assert (refusal.status_code, refusal.json()["code"]) == (404, "unknown_step")
    for since in ("-1", "x", "1.5", "2147483648", ""):
        refusal = server.client.get(f"{path}/{view}?since={since}")
        assert (refusal.status_code, refusal.json()["code"]) == (422, "invalid_request")


@each_body
def test_what_is_known_is_not_sent_again(
    server: Server, paths: Mapping[str, str], view: str
) -> None:
    url = f"{paths['paper']}/{view}?since=80"
    tag = server.client.get(url).headers["ETag"]
    again = server.client.get(url, headers={"If-None-Match": tag})
    assert (again.status_code, again.content) == (304, b"")


def test_changes_may_be_of_a_part(
    server: Server, twins: Mapping[str, Twin], paths: Mapping[str, str]
) -> None:
    box = (8.0, 4.2, 11.0, 8.0)
    state = twins["paper"].states[-1]
    zones = server.get(f"{paths['paper']}/zones", since=60, bbox="8,4.2,11,8")
    assert zones == zones_body(state, box, since=60)
    assert json.loads(zones)["total"] == len(json.loads(zones_body(state, box))["features"]) == 3
    for view, body in (("borders", borders_body), ("doorways", doorways_body)):
        told = server.get(f"{paths['paper']}/{view}", since=60, bbox="8,4.2,11,8", tolerance=0.1)
        assert told == body(state, box, 0.1, 60)


def test_names_are_told_with_what_changed(server: Server) -> None:
    path = server.create(world=paper_world())
    for document in paper_steps()[:8]:
        server.step(path, document)
    server.client.put(f"{path}/zones/corridor", json={"aliases": ["hall"]}).raise_for_status()
    zones = json.loads(server.get(f"{path}/zones", since=0))
    noted = {it["id"]: it["properties"].get("aliases") for it in zones["features"]}
    assert noted["corridor"] == ["hall"]
    graph = json.loads(server.get(f"{path}/graph", since=0))
    assert graph["nodes"][0]["aliases"] == ["hall"]
    assert json.loads(server.get(f"{path}/graph", since=8))["nodes"] == []
