"""The command `semtopo`, run as a process of its own."""

from __future__ import annotations

import gzip
import json
import os
import pty
import re
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import pytest

from semtopo.codec import graph_body, zones_body
from semtopo.formats import read_path, read_world
from semtopo.mapper import explore
from semtopo.readback import read_map
from semtopo.sensor import Sensor
from service.cli import main

SEMTOPO = Path(sys.executable).with_name("semtopo")
EXAMPLE = Path(__file__).parents[1] / "examples" / "paper"
WORLD, PATH = EXAMPLE / "world.json", EXAMPLE / "path.csv"
FILES = {
    "zones.geojson", "graph.json", "borders.geojson", "doorways.geojson", "steps.jsonl", "map.svg",
}  # fmt: skip
TIMINGS = {"measurement", "analysis", "extraction", "map_update", "graph_update", "total"}

Done = subprocess.CompletedProcess[str]


def semtopo(*arguments: str | Path, **variables: str) -> Done:
    """Run the command to its end."""
    return subprocess.run(
        [SEMTOPO, *arguments],
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
        encoding="utf-8",
        env={**os.environ, **variables},
    )


def names(folder: Path) -> set[str]:
    return {file.name for file in folder.iterdir()}


def steps_in(folder: Path) -> list[Any]:
    return [json.loads(line) for line in (folder / "steps.jsonl").read_bytes().splitlines()]


def recording(*beams: Any) -> bytes:  # noqa: ANN401 -- JSON
    """Give a recording with one scan for each list of beams."""
    about = {"angle_min": 0, "angle_increment": 0.7, "range_max": 4, "kinds": {"door": "passage"}}
    poses = [{"x": 1 + 0.1 * number, "y": 2, "theta": 0.1} for number in range(len(beams))]
    lines = [
        {"pose": pose, "scan": {**about, "beams": each}}
        for pose, each in zip(poses, beams, strict=True)
    ]
    return b"".join(json.dumps(line).encode() + b"\n" for line in lines)


HALL = [[["hall", 2.0]]] * 9
HALL_AND_ROOM = [[["hall", 2.0]]] * 5 + [[["hall", 2.0], ["door", 2.3], ["room", 3.0]]] * 4


@pytest.fixture(scope="module")
def mapped(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Done]:
    """Give the folder of the paper's drive at 36 beams, and what was printed."""
    folder = tmp_path_factory.mktemp("cli") / "made" / "map"
    return folder, semtopo("map", WORLD, PATH, "--beams", "36", "--out", folder)


class TestMap:
    def test_says_what_it_did(self, mapped: tuple[Path, Done]) -> None:
        folder, done = mapped
        assert (done.returncode, done.stderr) == (0, "")
        assert re.fullmatch(r"81 steps, 5 zones, 8 passages in \d+\.\d s\n", done.stdout)
        assert names(folder) == FILES

    def test_writes_the_bodies_of_http(self, mapped: tuple[Path, Done]) -> None:
        folder, _ = mapped
        path = [pose.position for pose in read_path(PATH.read_bytes())]
        *_, last = explore(read_world(WORLD.read_bytes()), Sensor(36), path)
        state = last.state
        zones, graph = (folder / "zones.geojson").read_bytes(), (folder / "graph.json").read_bytes()
        assert zones == zones_body(state)
        assert graph == graph_body(state.graph, state.seq)
        assert read_map(zones, graph).graph.nodes.keys() == {"corridor", "A", "B", "C", "D"}

    def test_writes_every_step(self, mapped: tuple[Path, Done]) -> None:
        steps = steps_in(mapped[0])
        assert [step["seq"] for step in steps] == list(range(1, 82))
        assert all(step["timings_ms"].keys() == TIMINGS for step in steps)
        assert all(time >= 0 for step in steps for time in step["timings_ms"].values())
        stages = [sum(step["timings_ms"][name] for name in TIMINGS - {"total"}) for step in steps]
        assert stages == pytest.approx([step["timings_ms"]["total"] for step in steps], abs=0.01)
        found = {
            step["seq"]: [e["type"] for e in step["events"]] for step in steps if step["events"]
        }
        assert list(found) == [1, 5, 7, 29, 42, 43, 66, 74, 75]

    def test_draws(self, mapped: tuple[Path, Done]) -> None:
        assert ET.parse(mapped[0] / "map.svg").getroot().tag.endswith("svg")  # noqa: S314 -- our own picture

    def test_writes_the_same_again_over_the_old(
        self, mapped: tuple[Path, Done], tmp_path: Path
    ) -> None:
        for name in FILES:
            (tmp_path / name).write_text("old")
        (tmp_path / "mine.txt").write_text("kept")
        semtopo("map", WORLD, PATH, "--beams", "36", "--out", tmp_path, PYTHONHASHSEED="7")
        assert names(tmp_path) == FILES | {"mine.txt"}
        for name in FILES - {"steps.jsonl"}:
            assert (tmp_path / name).read_bytes() == (mapped[0] / name).read_bytes()

    @pytest.mark.parametrize("pack", [bytes, gzip.compress], ids=["plain", "gzip"])
    def test_recording(self, tmp_path: Path, pack: Any) -> None:  # noqa: ANN401 -- bytes to bytes
        (tmp_path / "scans").write_bytes(pack(recording(HALL, HALL_AND_ROOM)))
        out = tmp_path / "map"
        done = semtopo("map", "--scans", tmp_path / "scans", "--edges", "adjacent", "--out", out)
        assert done.stdout.startswith("2 steps, 2 zones, 1 passages in ")
        first, _ = steps_in(out)
        assert first["timings_ms"]["measurement"] == 0
        assert names(out) == FILES

    def test_min_zone_area(self, tmp_path: Path) -> None:
        done = semtopo("map", WORLD, PATH, "--min-zone-area", "20", "--out", tmp_path)
        assert done.stdout.startswith("81 steps, 0 zones, 0 passages in ")
        assert "no zones yet" in (tmp_path / "map.svg").read_text(encoding="utf-8")

    def test_progress_is_for_terminals_only(self, tmp_path: Path) -> None:
        leader, follower = pty.openpty()
        command: list[str | Path] = [SEMTOPO, "map", WORLD, PATH, "--out", tmp_path]
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=follower, check=True)
        os.close(follower)
        shown = os.read(leader, 1_000_000).decode()
        os.close(leader)
        assert "mapping" in shown
        assert done.stdout.count(b"\n") == 1


class TestRoute:
    def test_sentence(self, mapped: tuple[Path, Done]) -> None:
        done = semtopo("route", mapped[0], "path from corridor to C")
        assert (done.returncode, done.stderr) == (0, "")
        assert re.fullmatch(
            r"Leave corridor at \(8\.\d, 4\.\d\) into C: \d+\.\d m, 1 passage\.\n", done.stdout
        )

    def test_json(self, mapped: tuple[Path, Done]) -> None:
        answer = json.loads(semtopo("route", mapped[0], "path from b to c", "--json").stdout)
        assert answer["kind"] == "path"
        assert answer["route"]["zones"] == ["B", "corridor", "C"]

    def test_any_script_on_any_terminal(self, tmp_path: Path) -> None:
        (tmp_path / "scans").write_bytes(recording([[["\u4f1a\u8b70\u5ba4", 2.0]]] * 9))
        semtopo("map", "--scans", tmp_path / "scans", "--out", tmp_path)
        question = "path from \u4f1a\u8b70\u5ba4 to \u4f1a\u8b70\u5ba4"
        done = semtopo("route", tmp_path, question, PYTHONIOENCODING="latin-1")
        assert done.returncode == 0
        assert done.stdout.startswith("You are in \\u4f1a")


def test_version() -> None:
    assert semtopo("--version").stdout == f"semtopo {version('semtopo')}\n"


@pytest.mark.parametrize("command", ["map", "route", "serve"])
def test_help(command: str) -> None:
    assert semtopo(command, "--help").returncode == 0


def test_map_and_route_do_not_wait_for_the_service() -> None:
    code = "import service.cli, sys; print({'fastapi', 'sqlalchemy', 'uvicorn'} & set(sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "set()\n"


def zone(**changes: object) -> str:
    hall = {"label": "hall", "kind": "space", "low": [0, 0], "high": [2, 1], **changes}
    return json.dumps({"zones": [hall]})


BAD_FILES = {
    "empty": "",
    "words.csv": "x,y\n1,2\n3,four\n",
    "nan.csv": "x,y\nnan,2\n",
    "heading.csv": "x,y,theta\n1,2,east\n",
    "header.csv": "1,2\n",
    "world.txt": "{",
    "flat.json": zone(high=[2, 0]),
    "none.json": '{"zones": []}',
    "infinite.json": zone(high=[2, float("inf")]),
    "descending.jsonl": recording(HALL, [[["hall", 2.0], ["room", 1.0]]]).decode(),
    "nan.jsonl": recording([[["hall", float("nan")]]]).decode(),
    "broken.gz": "\x1f\x8b",
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Give a folder of bad files."""
    folder = tmp_path_factory.mktemp("bad")
    for name, content in BAD_FILES.items():
        (folder / name).write_bytes(content.encode("latin-1"))
    return folder


@pytest.mark.parametrize(
    ("arguments", "fault"),
    [
        ("map {world} {path}", "Missing option '--out'."),
        ("map {world} --out {out}", "expected WORLD and PATH, or --scans"),
        ("map --out {out}", "expected WORLD and PATH, or --scans"),
        ("map {world} {path} --scans {path} --out {out}", "--scans takes no WORLD"),
        ("map --scans {path} --beams 9 --out {out}", "--scans takes no WORLD"),
        ("map {world} {path} {path} --out {out}", "Got unexpected extra argument"),
        ("map {bad}/missing {path} --out {out}", "{bad}/missing: No such file or directory"),
        ("map {bad} {path} --out {out}", "{bad}: Is a directory"),
        ("map {bad}/empty {path} --out {out}", "{bad}/empty: Invalid JSON"),
        ("map {bad}/world.txt {path} --out {out}", "{bad}/world.txt: Invalid JSON"),
        ("map {bad}/flat.json {path} --out {out}", "{bad}/flat.json: zones.0: low must be"),
        ("map {bad}/none.json {path} --out {out}", "{bad}/none.json: zones: List should have"),
        ("map {bad}/infinite.json {path} --out {out}", "{bad}/infinite.json: zones.0.high.1:"),
        ("map {world} {bad}/empty --out {out}", "{bad}/empty: the first line of a path must be"),
        ("map {world} {bad}/words.csv --out {out}", "{bad}/words.csv: line 3: expected numbers"),
        ("map {world} {bad}/nan.csv --out {out}", "{bad}/nan.csv: line 2: x: Input should be"),
        ("map {world} {bad}/heading.csv --out {out}", "{bad}/heading.csv: line 2: expected"),
        ("map {world} {bad}/header.csv --out {out}", "{bad}/header.csv: the first line of a path"),
        ("map {world} {path} --samples 1 --out {out}", "samples: Input should be greater than"),
        ("map {world} {path} --beams 0 --out {out}", "beams: Input should be greater than"),
        ("map {world} {path} --beams 1e3 --out {out}", "Invalid value for '--beams'"),
        ("map {world} {path} --beams 999999999 --out {out}", "beams: Input should be less than"),
        ("map {world} {path} --range nan --out {out}", "range: Input should be"),
        ("map {world} {path} --range -1 --out {out}", "range: Input should be greater than 0"),
        ("map {world} {path} --min-zone-area nan --out {out}", "min_zone_area must be a finite"),
        ("map {world} {path} --edges all --out {out}", "Invalid value for '--edges'"),
        ("map {world} {path} --out {path}", "{path}: File exists"),
        ("map {world} {path} --out {path}/x", "{path}/x: Not a directory"),
        ("map --scans {bad}/missing --out {out}", "{bad}/missing: No such file or directory"),
        ("map --scans {bad}/empty --out {out}", "{bad}/empty: the recording has no scan"),
        ("map --scans {bad}/words.csv --out {out}", "{bad}/words.csv: line 1: Invalid JSON"),
        (
            "map --scans {bad}/descending.jsonl --out {out}",
            "{bad}/descending.jsonl: line 2: beam 0",
        ),
        ("map --scans {bad}/nan.jsonl --out {out}", "{bad}/nan.jsonl: line 1: scan.beams.0.0.1:"),
        ("map --scans {bad}/broken.gz --out {out}", "{bad}/broken.gz: after line 0: the gzip"),
        ("route {bad} hello", "{bad}/zones.geojson: No such file or directory"),
        ("route {map} hello", 'Expected a question such as "path from'),
        (
            "route {map} path_from_corridor_to_Q",
            "The map knows nothing by the name at character 23.",
        ),
        ("serve --port 70000", "port: Input should be less than or equal to 65535"),
        ("serve --port x", "Invalid value for '--port'"),
        ("nonsense", "No such command 'nonsense'."),
        ("--nonsense", "No such option: --nonsense"),
    ],
)
def test_bad_input(  # noqa: PLR0913, PLR0917 -- fixtures
    arguments: str,
    fault: str,
    folder: Path,
    mapped: tuple[Path, Done],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    out = tmp_path / "out"
    values = {"world": WORLD, "path": PATH, "bad": folder, "map": mapped[0], "out": out}
    words = [word.format(**values) for word in arguments.split()]
    words = [word.replace("_", " ") if word.startswith("path_") else word for word in words]
    # in this process: to start one takes two seconds; the tests below do
    monkeypatch.setattr(sys, "argv", ["semtopo", *words])
    with pytest.raises(SystemExit) as ended:
        main()
    printed, told = capsys.readouterr()
    assert (ended.value.code, printed) == (2, "")
    assert told.startswith("semtopo: " + fault.format(**values))
    assert told.count("\n") == 1
    assert not out.exists()


@pytest.mark.parametrize(
    "words",
    [
        ["map", WORLD, PATH],
        ["map", WORLD, PATH, "--range", "nan", "--out", "out"],
        ["map", WORLD, "missing", "--out", "out"],
        ["serve", "--port", "70000"],
        ["nonsense"],
    ],
)
def test_bad_input_of_a_process(words: list[str | Path]) -> None:
    done = semtopo(*words)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith("semtopo: ")
    assert done.stderr.count("\n") == 1
    assert not Path("out").exists()


def test_no_route(tmp_path: Path) -> None:
    (tmp_path / "scans").write_bytes(recording(HALL_AND_ROOM))
    semtopo("map", "--scans", tmp_path / "scans", "--out", tmp_path)
    done = semtopo("route", tmp_path, "path from room to hall")
    assert done.returncode == 2
    assert done.stderr.startswith("semtopo: There is no way from room to hall yet")
    assert done.stderr.count("\n") == 1


def test_files_of_two_maps(mapped: tuple[Path, Done], tmp_path: Path) -> None:
    (tmp_path / "zones.geojson").write_bytes((mapped[0] / "zones.geojson").read_bytes())
    (tmp_path / "graph.json").write_text('{"seq": 1, "nodes": [], "edges": []}')
    done = semtopo("route", tmp_path, "path from corridor to C")
    assert done.returncode == 2
    assert done.stderr == "semtopo: these are not the zones and the graph of a map\n"


def test_a_failure_loses_nothing(mapped: tuple[Path, Done], folder: Path, tmp_path: Path) -> None:
    for name in FILES:
        (tmp_path / name).write_bytes((mapped[0] / name).read_bytes())
    done = semtopo("map", "--scans", folder / "descending.jsonl", "--out", tmp_path)
    assert done.returncode == 2
    assert names(tmp_path) == FILES
    assert all((tmp_path / n).read_bytes() == (mapped[0] / n).read_bytes() for n in FILES)


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a device that is always full")
def test_full_disk_for_the_answer(mapped: tuple[Path, Done]) -> None:
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(
            [SEMTOPO, "route", mapped[0], "path from corridor to C"],
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            check=False,
        )
    assert done.returncode == 2
    assert done.stderr == "semtopo: [Errno 28] No space left on device\n"
