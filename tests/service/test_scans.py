"""Sessions of real robots: labelled scans over HTTP, drawn ones and recorded ones."""

from __future__ import annotations

import gzip
import json
import math
from itertools import islice

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from semtopo.runs import LabelledRuns
from semtopo.types import MappingOptions, Pose
from tests.servers import Json, Server
from tests.service.twin import (
    ROOT,
    Twin,
    at,
    options_json,
    paper_steps,
    paper_world,
    scan_step,
    untimed,
)
from tests.strategies import all_options, labelled_runs, poses

RECORDING = ROOT.parent / "shared" / "data" / "freiburg079" / "scans.jsonl.gz"
REAL_STEPS = 60


def assert_alike(server: Server, path: str, twin: Twin) -> None:
    assert server.get(f"{path}/graph") == twin.graph()
    assert server.get(f"{path}/zones") == twin.zones()


def seen(*kinds: str) -> Json:
    """Return a scan all around through three rings of labels, which have these kinds."""
    beams = 36
    runs = [["inner", 1.0], ["middle", 1.5], ["outer", 3.0]]
    labels = zip(("inner", "middle", "outer"), kinds, strict=True)
    return {
        "angle_min": 0.0,
        "angle_increment": 2 * math.pi / beams,
        "range_max": 4.0,
        "beams": [runs] * beams,
        "kinds": {label: kind for label, kind in labels if kind},
    }


@pytest.mark.parametrize(
    ("kinds", "nodes", "edges"),
    [
        (("", "passage", ""), ["inner", "outer"], [("inner", "outer")]),
        (("space", "passage", "space"), ["inner", "outer"], [("inner", "outer")]),
        (("", "unknown", ""), ["inner", "outer"], [("inner", "outer")]),
        (("", "obstacle", ""), ["inner"], []),
        (("", "", "unknown"), ["inner", "middle"], [("inner", "middle")]),
        (("unknown", "unknown", "unknown"), [], []),
        (("unknown", "", "unknown"), ["middle"], []),
    ],
)
def test_kinds_say_what_a_label_is(
    server: Server, kinds: tuple[str, ...], nodes: list[str], edges: list[tuple[str, str]]
) -> None:
    path = server.create()
    twin = Twin.driven({}, [at(0, 0, 0, seen(*kinds))])
    assert untimed(server.step(path, at(0, 0, 0, seen(*kinds)))) == twin.answers[0]
    graph = json.loads(server.get(f"{path}/graph"))
    assert sorted(node["id"] for node in graph["nodes"]) == nodes
    assert [(edge["source"], edge["target"]) for edge in graph["edges"]] == edges
    assert_alike(server, path, twin)


def test_unknown_between_links_no_neighbours(server: Server) -> None:
    path = server.create(mapping={"edges": "adjacent"})
    server.step(path, at(0, 0, 0, seen("", "unknown", "")))
    assert json.loads(server.get(f"{path}/graph"))["edges"] == []
    server.step(path, at(0, 0, 0, seen("", "passage", "")))
    assert len(json.loads(server.get(f"{path}/graph"))["edges"]) == 1


@settings(
    max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(
    steps=st.lists(st.tuples(poses, labelled_runs()), min_size=1, max_size=4), chosen=all_options
)  # fmt: skip
def test_drawn_scans(
    server: Server, steps: list[tuple[Pose, LabelledRuns]], chosen: MappingOptions
) -> None:
    session = {"mapping": options_json(chosen)}
    path, twin = server.create(**session), Twin(session)
    for pose, runs in steps:
        document = scan_step(pose, runs)
        assert untimed(server.step(path, document)) == twin.step(document)
    assert_alike(server, path, twin)
    assert server.get(f"{path}/zones", at=1) == twin.zones(1)
    server.client.delete(path)


def recorded(count: int) -> list[Json]:
    """Return the first steps of a real robot's drive."""
    if not RECORDING.exists():
        pytest.skip(f"NOT TESTED ON REAL SCANS: there is no {RECORDING.name} beside the checkout")
    with gzip.open(RECORDING) as lines:
        scans = [json.loads(line) for line in islice(lines, count)]
    return [{"pose": scan["pose"], "scan": scan["scan"]} for scan in scans]


@pytest.mark.parametrize("edges", ["seen", "adjacent"])
def test_a_real_drive(server: Server, edges: str) -> None:
    session = {"name": "Freiburg 079", "mapping": {"edges": edges}}
    path, twin = server.create(**session), Twin(session)
    for document in recorded(REAL_STEPS):
        assert untimed(server.step(path, document)) == twin.step(document)
    assert_alike(server, path, twin)
    assert server.get(f"{path}/zones", at=30) == twin.zones(30)
    steps = json.loads(server.get(f"{path}/steps"))["steps"]
    assert [step["input"] for step in steps] == recorded(REAL_STEPS)
    assert len(twin.states[-1].graph.nodes) > 1


def test_two_sessions_side_by_side(server: Server) -> None:
    """A real robot and a simulated one, turn by turn: neither touches the other."""
    drives = [({}, recorded(20)), ({"world": paper_world()}, paper_steps()[:20])]
    sessions = [(server.create(**session), Twin(session), steps) for session, steps in drives]
    for turn in range(20):
        for path, twin, steps in sessions:
            assert untimed(server.step(path, steps[turn])) == twin.step(steps[turn])
    for path, twin, _ in sessions:
        assert_alike(server, path, twin)
