"""Whatever comes in: a clean refusal, soon, with a code; and the map is as it was before."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx2
import pytest

from service.arguments import MEMBERS_MAX, VALUES_MAX
from service.schemas.problems import ProblemAnswer
from service.settings import Settings
from tests.servers import Json, Server
from tests.service.twin import at, paper_steps, paper_world

SECONDS_MAX = 10.0
"""For an answer; generous, since tests run beside each other."""

WORK_SECONDS_MAX = 0.3
"""For the server to work on one request, by its own clock; a quiet machine takes less than 0.1."""

GROWTH_BYTES_MAX = 50e6
"""By how much the server may grow over all that is sent here."""

BODY_BYTES_MAX: int = Settings.model_fields["body_bytes_max"].default

MARKER = "h1dden-h1dden"
"""A word that no answer may repeat."""


def case(name: str, *values: Any) -> Any:  # noqa: ANN401 -- a row of any table
    return pytest.param(*values, id=name)


@pytest.fixture
def mapped(server: Server) -> str:
    """Give a session in the paper's world that knows `corridor` and `A`, but no way back."""
    path = server.create(world=paper_world())
    for document in paper_steps()[4:5]:
        server.step(path, document)
    return path


@pytest.fixture
def empty(server: Server) -> str:
    """Give a session without a world."""
    return server.create()


@pytest.fixture(scope="module", autouse=True)
def lean(lasting_server: Server) -> Iterator[None]:
    """See to it that the server is never much larger than before the tests."""
    process = Path("/proc", str(lasting_server.pid))
    if process.exists():
        (process / "clear_refs").write_text("5")  # the peak begins anew
    before = metric(lasting_server, "process_resident_memory_bytes")
    yield
    assert metric(lasting_server, "process_resident_memory_bytes") - before < GROWTH_BYTES_MAX
    if process.exists():
        (peak,) = re.findall(r"VmHWM:\s+(\d+) kB", (process / "status").read_text())
        assert 1024 * int(peak) - before < GROWTH_BYTES_MAX


@pytest.fixture(autouse=True)
def unharmed(server: Server, mapped: str, empty: str) -> Iterator[None]:
    """See to it that both sessions are after the test as they were before, and still work."""

    def shown() -> list[bytes]:
        bodies = [f"{path}{body}" for path in (mapped, empty) for body in ("", "/graph", "/zones")]
        return [server.get(body) for body in [*bodies, f"{mapped}/steps", f"{empty}/steps"]]

    before = shown()
    yield
    assert shown() == before
    assert server.step(mapped, paper_steps()[0])["seq"] == 2
    assert server.step(empty, at(0, 0, 0, scan()))["seq"] == 1


def refused(answer: httpx2.Response, status: int, code: str) -> ProblemAnswer:
    """Hold a refusal against what the interface promises of all of them."""
    assert (answer.status_code, answer.headers["Content-Type"], answer.json().get("code")) == (
        status, "application/problem+json", code,
    ), answer.text[:500]  # fmt: skip
    assert answer.elapsed.total_seconds() < SECONDS_MAX
    assert MARKER not in answer.text
    assert "Traceback" not in answer.text
    assert len(answer.content) < 8_000
    problem = ProblemAnswer.model_validate_json(answer.content)
    assert (problem.status, problem.type) == (status, f"urn:semtopo:{code}")
    assert len(problem.errors or []) <= 10
    return problem


def raw(server: Server, path: str, body: bytes, kind: str = "application/json") -> httpx2.Response:
    return server.client.post(path, content=body, headers={"Content-Type": kind})


def text(document: object) -> bytes:
    """Write JSON as Python does: NaN and Infinity bare, lone surrogates escaped."""
    return json.dumps(document).encode()


def verdict(body: bytes, status: int, code: str) -> tuple[int, str]:
    """Return what is answered to a body: JSON with a lone surrogate is none (RFC 7493, 2.1)."""
    return (400, "malformed_json") if re.search(rb"\\ud[89a-f]", body) else (status, code)


def scan(**changed: object) -> Json:
    """Return a good scan, but for what is changed."""
    good: Json = {
        "angle_min": 0.0, "angle_increment": 0.1, "range_max": 4.0,
        "beams": [[["a", 1.0], ["b", 2.0]], [["a", 2.0]]], "kinds": {"a": "space"},
    }  # fmt: skip
    return {**good, **changed}


def zone(**changed: object) -> Json:
    """Return a good zone, but for what is changed."""
    good: Json = {"label": "a", "kind": "space", "low": [0, 0], "high": [1, 1]}
    return {**good, **changed}


def without(document: Json, *names: str) -> Json:
    return {key: value for key, value in document.items() if key not in names}


NOT_NUMBERS = {
    "NaN": float("nan"), "Infinity": float("inf"), "-Infinity": float("-inf"), "text": "1.0",
    "true": True, "null": None, "list": [1.0], "object": {}, "too large": 1e7,
    "far too large": 1e300,
}  # fmt: skip
NOT_LABELS = {
    "empty": "", "lone surrogate": "\ud800", "NUL": "a\0b", "newline": "a\nb", "escape": "\x1b[2J",
    "delete": "\x7f", "right-to-left override": "\u202e", "line separator": "\u2028",
    "space before": " a", "space after": "a ", "overlong": "a" * 101, "number": 1, "null": None,
    "list": ["a"], "no character": "\uffff", "zero width space": "\u200b",
}  # fmt: skip


# Steps

STEPS = [
    *(case(f"x {name}", "mapped", {"pose": {"x": it, "y": 0}}, "invalid_pose")
      for name, it in NOT_NUMBERS.items()),
    *(case(f"theta {name}", "mapped", {"pose": {"x": 0, "y": 0, "theta": it}}, "invalid_pose")
      for name, it in NOT_NUMBERS.items()),
    case("no y", "mapped", {"pose": {"x": 0}}, "invalid_pose"),
    case("no pose", "mapped", {}, "invalid_pose"),
    case("pose null", "mapped", {"pose": None}, "invalid_pose"),
    case("pose a list", "mapped", {"pose": [1, 2]}, "invalid_pose"),
    case("field too much", "mapped", {**at(1, 6), "speed": MARKER}, "invalid_request"),
    case("field too much in pose", "mapped", {"pose": {"x": 0, "y": 0, "z": MARKER}},
         "invalid_pose"),
    case("surrogate as field", "mapped", {**at(1, 6), "\ud800": 1}, "invalid_request"),
    case("surrogate as field in pose", "mapped", {"pose": {"x": 0, "\udfff": 0}}, "invalid_pose"),
    case("field of a strange name", "mapped", {**at(1, 6), MARKER: 1}, "invalid_request"),
    case("field of a strange name in scan", "empty", at(0, 0, 0, scan(**{MARKER: 1})),
         "invalid_scan"),
    case("kind of a strange name", "empty", at(0, 0, 0, scan(kinds={MARKER: 1, "\ud800": 1})),
         "invalid_scan"),
    case("64 fields", "mapped", {f"f{n}": MARKER for n in range(64)}, "invalid_pose"),
    case("many fields", "mapped", {f"f{n}": MARKER for n in range(500)}, "invalid_request"),
    *(case(f"seq {it!r}", "mapped", {**at(1, 6), "seq": it}, "invalid_request")
      for it in (0, -1, 2**31, 10**30, 1.0, 1.5, "1", True, [1], float("nan"))),
    case("scan a list", "empty", at(0, 0) | {"scan": []}, "invalid_scan"),
    case("scan without beams", "empty", at(0, 0, 0, without(scan(), "beams")), "invalid_scan"),
    case("scan with more", "empty", at(0, 0, 0, scan(extra=MARKER)), "invalid_scan"),
    *(case(f"{field} {name}", "empty", at(0, 0, 0, scan(**{field: it})), "invalid_scan")
      for field in ("angle_min", "angle_increment", "range_max")
      for name, it in NOT_NUMBERS.items()),
    *(case(f"radius {name}", "empty", at(0, 0, 0, scan(beams=[[["a", it]]])), "invalid_scan")
      for name, it in NOT_NUMBERS.items()),
    *(case(f"label {name}", "empty", at(0, 0, 0, scan(beams=[[[it, 1.0]]])), "invalid_scan")
      for name, it in NOT_LABELS.items()),
    *(case(f"kinds {name}", "empty", at(0, 0, 0, scan(kinds={it: "space"})), "invalid_scan")
      for name, it in NOT_LABELS.items() if isinstance(it, str)),
    case("unknown kind", "empty", at(0, 0, 0, scan(kinds={"a": MARKER})), "invalid_scan"),
    case("kind in capitals", "empty", at(0, 0, 0, scan(kinds={"a": "SPACE"})), "invalid_scan"),
    case("kind as number", "empty", at(0, 0, 0, scan(kinds={"a": 0})), "invalid_scan"),
    case("1001 kinds", "empty", at(0, 0, 0, scan(kinds={f"k{n}": "space" for n in range(1001)})),
         "invalid_scan"),
    case("range 0", "empty", at(0, 0, 0, scan(range_max=0.0)), "invalid_scan"),
    case("range below 0", "empty", at(0, 0, 0, scan(range_max=-1.0)), "invalid_scan"),
    case("radius 0", "empty", at(0, 0, 0, scan(beams=[[["a", 0.0]]])), "invalid_scan"),
    case("radius below 0", "empty", at(0, 0, 0, scan(beams=[[["a", -1.0]]])), "invalid_scan"),
    case("radii that descend", "empty", at(0, 0, 0, scan(beams=[[["a", 2.0], ["b", 1.0]]])),
         "invalid_scan"),
    case("equal radii", "empty", at(0, 0, 0, scan(beams=[[["a", 2.0], ["b", 2.0]]])),
         "invalid_scan"),
    case("radius beyond range", "empty", at(0, 0, 0, scan(beams=[[["a", 4.5]]])), "invalid_scan"),
    case("more than a turn", "empty", at(0, 0, 0, scan(beams=[[["a", 1.0]]] * 64)), "invalid_scan"),
    case("more than a turn back", "empty",
         at(0, 0, 0, scan(beams=[[]] * 64, angle_increment=-0.1)), "invalid_scan"),
    case("beams all in one", "empty", at(0, 0, 0, scan(angle_increment=0.0)), "invalid_scan"),
    case("run without radius", "empty", at(0, 0, 0, scan(beams=[[["a"]]])), "invalid_scan"),
    case("run of three", "empty", at(0, 0, 0, scan(beams=[[["a", 1.0, 2.0]]])), "invalid_scan"),
    case("run turned round", "empty", at(0, 0, 0, scan(beams=[[[1.0, "a"]]])), "invalid_scan"),
    case("beams flat", "empty", at(0, 0, 0, scan(beams=[["a", 1.0]])), "invalid_scan"),
    case("beams an object", "empty", at(0, 0, 0, scan(beams={"0": []})), "invalid_scan"),
    case("4001 beams", "empty", at(0, 0, 0, scan(beams=[[]] * 4001, angle_increment=1e-4)),
         "invalid_scan"),
    case("20,001 runs in all", "empty",
         at(0, 0, 0, scan(beams=[[["a", (n + 1) / 2] for n in range(6)]] * 3_334,
                          angle_increment=1e-3)), "invalid_scan"),
    case("1001 labels", "empty",
         at(0, 0, 0, scan(beams=[[[f"l{m}{n}", (n + 1) / 999] for n in range(143)]
                                 for m in range(7)])), "invalid_scan"),
    case("1001 runs", "empty",
         at(0, 0, 0, scan(beams=[[["a", n / 1000] for n in range(1, 1002)]])), "invalid_scan"),
]  # fmt: skip


@pytest.mark.parametrize(("session", "document", "code"), STEPS)
def test_a_bad_step(
    server: Server, request: pytest.FixtureRequest, session: str, document: Json, code: str
) -> None:
    path: str = request.getfixturevalue(session)
    body = text(document)
    refused(raw(server, f"{path}/step", body), *verdict(body, 422, code))


def test_a_number_that_is_beyond_all(server: Server, mapped: str) -> None:
    for number in (b"1e999", b"-1e999", b"1" * 4000):
        body = b'{"pose":{"x":%b,"y":0}}' % number
        refused(raw(server, f"{mapped}/step", body), 422, "invalid_pose")


def test_a_step_without_a_scan_needs_a_world(server: Server, empty: str) -> None:
    for document in (at(0, 0), {**at(0, 0), "seq": 1}, {**at(0, 0), "scan": None}):
        refused(raw(server, f"{empty}/step", text(document)), 409, "no_world")


def test_a_gap_in_a_session(server: Server, empty: str) -> None:
    document = {**at(0, 0, 0, scan()), "seq": 2}
    assert refused(raw(server, f"{empty}/step", text(document)), 409, "sequence_gap").expected == 1


# Sessions

WORLDS = [
    case("no zones", {"zones": []}),
    case("zones missing", {"name": "x"}),
    case("a list", []),
    case("a text", MARKER),
    case("a name too much", {"zones": [zone()], "scale": 1}),
    case("bad in a zone of a strange name", {"zones": [zone(label=MARKER, low=[2, 0])]}),
    case("10,001 zones", {"zones": [zone()] * 10_001}),
    case("low above high in x", {"zones": [zone(low=[2, 0])]}),
    case("low above high in y", {"zones": [zone(low=[0, 2])]}),
    case("low is high", {"zones": [zone(low=[1, 1])]}),
    case("low is high in x", {"zones": [zone(low=[1, 0])]}),
    case("one number in a corner", {"zones": [zone(low=[1])]}),
    case("three numbers in a corner", {"zones": [zone(low=[0, 0, 0])]}),
    case("a corner as object", {"zones": [zone(low={"x": 0, "y": 0})]}),
    case("unknown kind", {"zones": [zone(kind=MARKER)]}),
    case("no label", {"zones": [without(zone(), "label")]}),
    case("a field too much", {"zones": [zone(height=2.5)]}),
    case("zone null", {"zones": [None]}),
    case("the last is bad", {"zones": [zone()] * 50 + [zone(kind="lava")]}),
    case("name overlong", {"name": "n" * 101, "zones": [zone()]}),
    case("name with NUL", {"name": "\0", "zones": [zone()]}),
    case("name a lone surrogate", {"name": "\udc00", "zones": [zone()]}),
    case("name a number", {"name": 1, "zones": [zone()]}),
    *(case(f"corner {name}", {"zones": [zone(high=[1, it])]}) for name, it in NOT_NUMBERS.items()),
    *(case(f"label {name}", {"zones": [zone(label=it)]}) for name, it in NOT_LABELS.items()),
]


@pytest.mark.parametrize("world", WORLDS)
def test_a_bad_world(server: Server, world: object) -> None:
    body = text({"world": world})
    refused(raw(server, "/sessions", body), *verdict(body, 422, "invalid_world"))


@pytest.mark.parametrize(
    ("part", "value", "code"),
    [
        *(("sensor", {"beams": it}, "invalid_sensor") for it in (0, -1, 4001, 1.5, "72", True)),
        *(("sensor", {"samples": it}, "invalid_sensor") for it in (1, 0, 2001, 2.5, None)),
        *(("sensor", {"range": it}, "invalid_sensor") for it in (0, -1, 1e5, "2", True, 1e-400)),
        ("sensor", {"beams": 1_001, "samples": 100}, "invalid_sensor"),
        ("sensor", {"beams": 4_000, "samples": 2_000}, "invalid_sensor"),
        ("sensor", {"radius": 2}, "invalid_sensor"),
        ("sensor", [], "invalid_sensor"),
        ("sensor", None, "invalid_sensor"),
        *(("mapping", {"edges": it}, "invalid_option") for it in ("none", "SEEN", "", 1, ["seen"])),
        *(("mapping", {"min_zone_area": it}, "invalid_option") for it in (-1, "0", 1e7, False)),
        *(("mapping", {"tolerance": it}, "invalid_option") for it in (-0.1, "0.1", 1e9, True)),
        ("mapping", {"simplify": 0.1}, "invalid_option"),
        ("mapping", "adjacent", "invalid_option"),
        *(("name", it, "invalid_request") for it in ("", 1, "\ud800", "\0", "n" * 101, "a\n")),
        ("id", "mine", "invalid_request"),
    ],
)
def test_a_bad_session(server: Server, part: str, value: object, code: str) -> None:
    body = text({part: value})
    refused(raw(server, "/sessions", body), *verdict(body, 422, code))


# Addresses

QUERIES = [
    case("route to nowhere", "/route?from=corridor&to=nowhere", 404, "unknown_zone"),
    case("route from nowhere", f"/route?from={MARKER}&to=A", 404, "unknown_zone"),
    case("route without an edge", "/route?from=A&to=corridor", 409, "no_route"),
    case("route without a start", "/route?to=A", 422, "invalid_request"),
    case("route without an end", "/route?from=A", 422, "invalid_request"),
    case("route to a void", "/route?from=A&to=", 422, "invalid_request"),
    case("route to an overlong name", f"/route?from=A&to={'a' * 101}", 422, "invalid_request"),
    case("route to NUL", "/route?from=A&to=%00", 404, "unknown_zone"),
    case("route to no UTF-8", "/route?from=A&to=%ED%A0%80%FF", 404, "unknown_zone"),
    *(case(f"graph at {it}", f"/graph?at={it}", 422, "invalid_request")
      for it in ("-1", "2147483648", "9" * 30, "1.5", "1e1", "x", "", "NaN", "0x1")),
    *(case(f"tolerance {it}", f"/borders?tolerance={it}", 422, "invalid_request")
      for it in ("", "-1", "nan", "inf", "1000001", "1e")),
    case("borders at no step", "/borders?at=-1", 422, "invalid_request"),
    *(case(f"{body} beyond", f"/{body}?at=2", 404, "unknown_step")
      for body in ("graph", "zones", "borders", "doorways")),
    *(case(f"picture {it}", f"/map.svg?{it}", 422, "invalid_request")
      for it in ("width=239", "height=4097", "width=-1", "width=1e3", "width=", "at=-1",
                 "from=corridor", "to=A", "from=&to=A", "from=A&to=A&radius=-1", "radius=nan",
                 "from=A&to=A&avoid=", "from=A&to=A&via=", "two_way=perhaps",
                 "from=A&to=A" + 101 * "&avoid=A", "from=A&to=A" + 21 * "&via=A",
                 f"layers={'a' * 201}")),
    *(case(f"layers {it}", f"/map.png?layers={it}", 422, "invalid_option")
      for it in ("", "walls", "zones,,graph", "%00", MARKER)),
    *(case(f"export {it}", f"/export/{it}", 422, "invalid_request")
      for it in ("gml", "NAV2", "%00", "nav2?radius=-1", "nav2?radius=nan", "nav2?radius=11",
                 "dot?radius=1e400", "geojson?at=-1")),
    case("export beyond", "/export/dot?at=2", 404, "unknown_step"),
    case("export of no ways", "/export/nav2?at=0", 409, "not_exportable"),
    case("picture of another kind", "/map.gif", 422, "invalid_request"),
    case("picture beyond", "/map.png?at=2", 404, "unknown_step"),
    case("picture of no route", "/map.png?from=A&to=corridor", 409, "no_route"),
    case("picture of nowhere", f"/map.svg?from={MARKER}&to=A", 404, "unknown_zone"),
    *(case(f"{view} since {it}", f"/{view}?since={it}", 422, "invalid_request")
      for view in ("zones", "graph", "borders", "doorways") for it in ("-1", "x", "2147483648")),
    case("zones since the largest", "/zones?since=2147483647", 404, "unknown_step"),
    case("zones at the largest", "/zones?at=2147483647", 404, "unknown_step"),
    *(case(f"bbox {it}", f"/zones?bbox={it}", 422, "invalid_request")
      for it in ("", "1,2,3", "1,2,3,4,5", "a,b,c,d", "nan,0,1,1", "inf,0,1,1", "1e1,0,20,1",
                 "2,0,1,1", "0,2,1,1", "0,0,1000001,1", "0;0;1;1", "1" * 101)),
    *(case(f"steps after {it}", f"/steps?after={it}", 422, "invalid_request")
      for it in ("-1", "2147483648", "x", "1.5")),
    *(case(f"steps limit {it}", f"/steps?limit={it}", 422, "invalid_request")
      for it in ("0", "-1", "1001", "x")),
]  # fmt: skip


@pytest.mark.parametrize(("below", "status", "code"), QUERIES)
def test_a_bad_query(server: Server, mapped: str, below: str, status: int, code: str) -> None:
    refused(server.client.get(mapped + below), status, code)


@pytest.mark.parametrize("cursor", ["x", "-1", "", "1.5", "9" * 19, "1e3", "%00", "1%0A"])
def test_a_bad_cursor(server: Server, cursor: str) -> None:
    refused(server.client.get(f"/sessions?cursor={cursor}"), 422, "invalid_request")


@pytest.mark.parametrize(
    ("session_id", "status", "code"),
    [
        ("nobody", 404, "unknown_session"),
        ("a" * 64, 404, "unknown_session"),
        ("a" * 65, 422, "invalid_request"),
        ("a" * 60_000, 422, "invalid_request"),
        ("%00", 422, "invalid_request"),
        ("a%0A", 422, "invalid_request"),
        ("%ED%A0%80", 422, "invalid_request"),
        ("%F0%9F%A4%96", 422, "invalid_request"),
        ("a'%20OR%201=1--", 422, "invalid_request"),
        ("..%2fx", 404, "not_found"),
    ],
)
def test_a_bad_session_id(server: Server, session_id: str, status: int, code: str) -> None:
    path = f"/sessions/{session_id}"
    for below in (
        "",
        "/graph",
        "/zones",
        "/borders",
        "/doorways",
        "/map.svg",
        "/map.png",
        "/steps",
        "/route?from=a&to=b",
    ):
        refused(server.client.get(path + below), status, code)
    refused(server.client.delete(path), status, code)
    refused(raw(server, f"{path}/step", text(at(0, 0))), status, code)
    refused(raw(server, f"{path}/query", text({"text": "path from a to b"})), status, code)


@pytest.mark.parametrize(
    ("question", "status", "code"),
    [
        ("", 422, "invalid_question"),
        ("fly me to the moon", 422, "invalid_question"),
        (f"path {MARKER}", 422, "invalid_question"),
        ("path from A", 422, "invalid_question"),
        ("path from A to ", 422, "invalid_question"),
        ("path from A to B; DROP TABLE sessions", 404, "unknown_zone"),
        ('path from "" to A', 422, "invalid_question"),
        (f"path from corridor to {MARKER}", 404, "unknown_zone"),
        ("path from A to corridor", 409, "no_route"),
        ("x" * 2001, 422, "invalid_question"),
        ("path from " * 200, 422, "invalid_question"),
        ("path from a" + " to a" * 397, 422, "invalid_question"),
        ("path from a" + " " * 1980, 422, "invalid_question"),
        ("path from \ud800 to A", 422, "invalid_question"),
        ("path from \0 to A", 404, "unknown_zone"),
        (1, 422, "invalid_question"),
        (None, 422, "invalid_question"),
        (["path from A to B"], 422, "invalid_question"),
    ],
)
def test_a_bad_question(
    server: Server, mapped: str, question: object, status: int, code: str
) -> None:
    body = text({"text": question})
    refused(raw(server, f"{mapped}/query", body), *verdict(body, status, code))


# Bodies that are no JSON, or no modest one

MALFORMED = [
    case("half an object", b'{"pose":', "malformed_json"),
    case("words", b"pose x=1", "malformed_json"),
    case("single quotes", b"{'pose': 1}", "malformed_json"),
    case("a comma too much", b'{"pose": {"x": 1, "y": 1,},}', "malformed_json"),
    case("two documents", b"{}{}", "malformed_json"),
    case("NUL", b"\0", "malformed_json"),
    case("no UTF-8", b'{"pose": "\xff\xfe"}', "malformed_json"),
    case("a number of 5,000 digits", b'{"seq": ' + b"1" * 5000 + b"}", "malformed_json"),
    case("100,000 brackets", b"[" * 100_000, "malformed_json"),
    case("100,000 brackets closed", b"[" * 100_000 + b"]" * 100_000, "malformed_json"),
    case("40,000 braces", b'{"a":' * 40_000 + b"1" + b"}" * 40_000, "malformed_json"),
    case("half of UTF-16", '{"pose": {}}'.encode("utf-16")[:-3], "malformed_request"),
]


@pytest.mark.parametrize(("body", "code"), MALFORMED)
@pytest.mark.parametrize("below", ["/step", "/query", ""])
def test_a_body_that_is_no_json(
    server: Server, mapped: str, below: str, body: bytes, code: str
) -> None:
    refused(raw(server, mapped + below if below else "/sessions", body), 400, code)


@pytest.mark.parametrize("body", [b"", b"null", b"[]", b"1", b'"pose"', b"true", b"[{}]"])
@pytest.mark.parametrize("below", ["/step", "/query"])
def test_a_body_that_is_no_object(server: Server, mapped: str, below: str, body: bytes) -> None:
    refused(raw(server, mapped + below, body), 422, "invalid_request")


@pytest.mark.parametrize(
    "kind",
    ["text/plain", "", "application/xml", "application/x-www-form-urlencoded", "image/png",
     "multipart/form-data; boundary=x", "json", "application/json2"],
)  # fmt: skip
def test_a_body_that_does_not_say_it_is_json(server: Server, mapped: str, kind: str) -> None:
    refused(raw(server, f"{mapped}/step", text(at(1, 6)), kind), 415, "unsupported_media_type")


@pytest.mark.parametrize("below", ["/step", "/query", ""])
def test_a_body_of_64_mib(server: Server, mapped: str, below: str) -> None:
    path = mapped + below if below else "/sessions"
    refused(raw(server, path, b" " * 2**26), 413, "body_too_large")
    headers = {"Content-Type": "application/json"}
    chunks = (b" " * 2**20 for _ in range(64))
    refused(server.client.post(path, content=chunks, headers=headers), 413, "body_too_large")


def test_a_body_as_large_as_allowed_is_read(server: Server, mapped: str) -> None:
    refused(raw(server, f"{mapped}/step", b"{}".ljust(BODY_BYTES_MAX)), 422, "invalid_pose")
    refused(raw(server, f"{mapped}/step", b"{}".ljust(BODY_BYTES_MAX + 1)), 413, "body_too_large")


ROOM = BODY_BYTES_MAX - 500  # bytes for a crowd, in the largest body that is read
MANY = b"[" + b",".join([b"0"] * (ROOM // 2)) + b"]"
SCAN = b'{"pose":{"x":0,"y":0},"scan":{"angle_min":0,"angle_increment":1,"range_max":1,'
MANY_FIELDS = b",".join(b'"%06x":1' % number for number in range(ROOM // 11))

CROWDS = [
    case("very many beams", "/step", SCAN + b'"beams":' + MANY + b"}}", "invalid_scan"),
    case("very many runs", "/step", SCAN + b'"beams":[' + MANY + b"]}}", "invalid_scan"),
    case("a run of very many", "/step", SCAN + b'"beams":[[' + MANY + b"]]}}", "invalid_scan"),
    case("empty beams", "/step", SCAN + b'"beams":[' + b"[]," * (ROOM // 3 - 1) + b"[]]}}",
         "invalid_scan"),
    case("very many for a pose", "/step", b'{"pose":' + MANY + b"}", "invalid_pose"),
    case("very many for x", "/step", b'{"pose":{"y":0,"x":' + MANY + b"}}", "invalid_pose"),
    case("very many for a text", "/query", b'{"text":' + MANY + b"}", "invalid_question"),
    case("very many zones", "", b'{"world":{"zones":' + MANY + b"}}", "invalid_world"),
    case("very many for a sensor", "", b'{"sensor":' + MANY + b"}", "invalid_sensor"),
    case("a corner of very many", "",
         b'{"world":{"zones":[{"label":"a","kind":"space","high":[1,1],"low":' + MANY + b"}]}}",
         "invalid_world"),
    case("4,000 beams, each wrong", "/step",
         SCAN + b'"beams":[' + b",".join([b'[["a",-1]]'] * 4000) + b"]}}", "invalid_scan"),
    case("very many fields", "/step", b'{"pose":{"x":0,"y":0},' + MANY_FIELDS + b"}",
         "invalid_request"),
    case("very many fields in a pose", "/step", b'{"pose":{"x":0,"y":0,' + MANY_FIELDS + b"}}",
         "invalid_pose"),
    case("very many fields for a sensor", "", b'{"sensor":{' + MANY_FIELDS + b"}}",
         "invalid_sensor"),
    case("very many fields in a zone", "",
         b'{"world":{"zones":[{' + MANY_FIELDS + b"}]}}", "invalid_world"),
    case("64 fields in very many zones", "",
         b'{"world":{"zones":[' + b",".join([b"{%b}" % MANY_FIELDS[:11 * 64 - 1]] * 1_400) + b"]}}",
         "invalid_world"),
    case("a kind of very many", "/step",
         SCAN + b'"beams":[],"kinds":{"a":' + MANY + b"}}}", "invalid_scan"),
    case("1,000 kinds, each wrong", "/step",
         SCAN + b'"beams":[],"kinds":{' + MANY_FIELDS[:11_000 - 1] + b"}}}", "invalid_scan"),
    case("very many kinds", "/step", SCAN + b'"beams":[],"kinds":{' + MANY_FIELDS + b"}}}",
         "invalid_scan"),
]  # fmt: skip


@pytest.mark.parametrize("below", ["/step", "/query", ""])
@pytest.mark.parametrize("values", [b"[]", b"{}", b"1"])
def test_more_values_than_any_document_has(
    server: Server, mapped: str, below: str, values: bytes
) -> None:
    body = b"[" + b",".join([values] * (VALUES_MAX + 1)) + b"]"
    found = refused(
        raw(server, mapped + below if below else "/sessions", body), 422, "invalid_request"
    )
    assert str(VALUES_MAX) in found.detail


@pytest.mark.parametrize(("below", "body", "code"), CROWDS)
def test_a_crowd(server: Server, mapped: str, below: str, body: bytes, code: str) -> None:
    assert len(body) <= BODY_BYTES_MAX
    before = worked(server)
    values, members = sum(map(body.count, (b",", b"[", b"{"))), body.count(b":")
    is_crowd = values > VALUES_MAX or members > MEMBERS_MAX
    answer = raw(server, mapped + below if below else "/sessions", body)
    refused(answer, 422, "invalid_request" if is_crowd else code)
    assert worked(server) - before < WORK_SECONDS_MAX


def worked(server: Server) -> float:
    """Return for how many seconds the server has kept a processor busy."""
    return metric(server, "process_cpu_seconds_total")


def metric(server: Server, name: str) -> float:
    """Return a number that the server tells of itself."""
    found = re.search(rf"^{name} (\S+)", server.get("/metrics").decode(), re.MULTILINE)
    assert found is not None
    return float(found[1])


# What looks strange, and is fine


@pytest.mark.parametrize(
    "body",
    [
        text(at(1, 6)).decode().encode("utf-16"),
        b"\xef\xbb\xbf" + text(at(1, 6)),
        b'{"pose": {"x": 9, "y": 9}, "pose": {"x": 1, "y": 6}}',
        b' \n\t{"pose":{"x":1,"y":6}}\n ',
        b'{"pose":{"x":1,"y":6,"theta":-0.0},"scan":null,"seq":null}',
        b'{"pose":{"x":1.0000000000000000000000001,"y":6e0}}',
    ],
)
def test_strange_spellings_of_a_step(server: Server, body: bytes) -> None:
    path = server.create(world=paper_world())
    assert raw(server, f"{path}/step", body).json()["here"] == "corridor"


@pytest.mark.parametrize(
    "kind",
    ["application/json; charset=utf-8", "Application/JSON", "application/geo+json",
     "application/json;a=b"],
)  # fmt: skip
def test_ways_to_say_json(server: Server, kind: str) -> None:
    path = server.create(world=paper_world())
    assert raw(server, f"{path}/step", text(at(1, 6)), kind).status_code == 201


def test_a_post_without_a_body_needs_no_type(server: Server) -> None:
    refused(server.client.post("/sessions"), 422, "invalid_request")


@pytest.mark.parametrize(
    "label", ["Ä", "厨房", "🤖", "a b", "é", "'; --", '"', "<b>", "a" * 100, "\\"]
)
def test_labels_in_any_script_travel_unchanged(server: Server, label: str) -> None:
    path = server.create(name=label, world={"zones": [zone(label=label, high=[9, 9])]})
    assert server.step(path, at(1, 6))["here"] == label
    assert json.loads(server.get(f"{path}/zones"))["features"][0]["properties"]["label"] == label
    route = json.loads(server.get(f"{path}/route", **{"from": label, "to": label}))
    assert route["zones"] == [label]
    assert json.loads(server.get(path))["name"] == label
