"""A folder that `semtopo map` wrote answers what it can, and says what it does not know."""

from __future__ import annotations

import subprocess
from dataclasses import replace
from functools import partial
from itertools import permutations
from pathlib import Path

import orjson
import pytest

from semtopo.answers import answer
from semtopo.atlas import Atlas
from semtopo.errors import InvalidMapError, SemtopoError
from semtopo.errors.ways import NoRouteError
from semtopo.formats import read_path, read_world
from semtopo.mapper import scan_world
from semtopo.route import Place, RouteRequest, find_routes
from semtopo.sensor import Sensor
from semtopo.types import Edges, Identity, MappingOptions, Passages
from service.folder import read_folder
from service.mapping_run import Extras, timed_steps, write_map
from tests.servers import SEMTOPO
from tests.service.twin import PAPER


def written(directory: Path, steps: int) -> Path:
    """Map the first steps of the paper's path into a folder."""
    lines = (PAPER / "path.csv").read_text().splitlines(keepends=True)
    path = directory / "path.csv"
    path.write_text("".join(lines[: steps + 1]))
    command = [str(SEMTOPO), "map", str(PAPER / "world.json"), str(path), "--beams", "36"]
    subprocess.run([*command, "--out", str(directory / "map")], check=True, capture_output=True)
    return directory / "map"


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return written(tmp_path_factory.mktemp("whole"), 81)


@pytest.fixture
def bare(whole: Path, tmp_path: Path) -> Path:
    """Give a folder without steps, borders and doorways."""
    for name in ("zones.geojson", "graph.json"):
        (tmp_path / name).write_bytes((whole / name).read_bytes())
    return tmp_path


def line(zone: str, occupancy: str, coordinates: str) -> bytes:
    """Return borders of one piece."""
    about = f'"properties": {{"zone_id": "{zone}", "occupancy": "{occupancy}"}}'
    return f'{{"features": [{{"geometry": {{"coordinates": {coordinates}}}, {about}}}]}}'.encode()


def door(number: str) -> bytes:
    """Return doorways of which one has a number."""
    about = f'{{"ends": ["A", "corridor"], "number": {number}, "since": 1, "seq": 1}}'
    ground = '{"type": "Polygon", "coordinates": [[[0, 0], [1, 0], [1, 1], [0, 0]]]}'
    return f'{{"features": [{{"geometry": {ground}, "properties": {about}}}]}}'.encode()


def told(folder: Path, question: str) -> str:
    """Return the answer, or the refusal."""
    read = read_folder(folder)
    try:
        return answer(read.atlas, question, read.history).sentence
    except SemtopoError as refused:
        return f"{refused.code}: {refused}"


@pytest.mark.parametrize(
    ("question", "beginning"),
    [
        ("path from A to C via corridor", "Leave A at"),
        ("is there a way from A to C", "Yes. Leave A at"),
        ("how far is C from here", "From corridor to C it is"),
        ("nearest C", "The nearest is C."),
        ("where am I", "You are in corridor."),
        ("where is C", "C is at"),
        ("what is next to here", "Next to corridor are"),
        ("which zones are reachable from C", "From C one reaches corridor, A, B and D."),
        ("from which zones can C be reached", "One reaches C from corridor, A, B and D."),
        ("what did I see at step 29", "In C, step 29 found new: C; linked: C -> corridor at ("),
        ("what did I see at step 30", "In C, step 30 found nothing new."),
        ("what did I see at step 81", "In corridor, step 81 found"),
        ("what changed between step 29 and 43", "Between step 29 and step 43: new: B; linked:"),
        ("what changed since step 0", "Between step 0 and step 81: new: corridor, A, C, B and D;"),
        ("list zones", "There are 5 zones: corridor, A, C, B and D."),
        ("list classes", "No zone has a class yet."),
        ("what is unexplored in C", "Unexplored in C: "),
        ("what did I see at step 82", "unknown_step: The last step was 81."),
        ("path from C to coridor", "unknown_zone: The map knows nothing by the name"),
    ],
)
def test_what_is_told(whole: Path, question: str, beginning: str) -> None:
    assert told(whole, question).startswith(beginning)


def test_without_the_steps(bare: Path) -> None:
    assert told(bare, "path from A to C").startswith("Leave A at")
    assert told(bare, "go to C").startswith("unknown_position")
    assert told(bare, "what changed since step 5").startswith("unknown_step: The folder does not")
    assert told(bare, "what changed since step 0").startswith("Between step 0 and step 81")
    assert told(bare, "what is unexplored in C").startswith("unknown_border: The map holds no")


@pytest.mark.parametrize("lines", [b"x", b"[]", b'{"seq": 1}', b"\xff"])
def test_steps_that_are_none(bare: Path, lines: bytes) -> None:
    (bare / "steps.jsonl").write_bytes(lines)
    with pytest.raises(InvalidMapError, match=r"steps\.jsonl: a line is"):
        read_folder(bare)


def test_steps_that_say_nothing_of_this_map(bare: Path) -> None:
    (bare / "steps.jsonl").write_bytes(b'{"here": "nowhere"}\n' * 81)
    assert told(bare, "where am I").startswith("unknown_position")


def test_a_refusal_names_the_missing_passage_and_the_frontier(tmp_path: Path) -> None:
    folder = written(tmp_path, 29)
    read = read_folder(folder)
    with pytest.raises(NoRouteError, match="C -> corridor has been since step 29") as refused:
        answer(read.atlas, "path from corridor to C", read.history)
    assert refused.value.frontier is not None
    assert "The frontier nearest to closing the gap is at" in str(refused.value)
    (folder / "borders.geojson").unlink()
    read = read_folder(folder)
    with pytest.raises(NoRouteError) as bare:
        answer(read.atlas, "path from corridor to C", read.history)
    assert bare.value.frontier is None
    assert "frontier" not in str(bare.value)


OPTIONS = [
    MappingOptions(),
    MappingOptions(edges=Edges.ADJACENT, passages=Passages.ALL, identity=Identity.INSTANCE),
    MappingOptions(tolerance=0.05),
]


@pytest.mark.parametrize("options", OPTIONS, ids=["paper", "instances", "reduced"])
def test_a_folder_answers_as_the_map_does(options: MappingOptions, tmp_path: Path) -> None:
    """Also along dense paths, which need the doorways, and about frontiers, which need borders."""
    world = read_world((PAPER / "world.json").read_bytes())
    path = [pose.position for pose in read_path((PAPER / "path.csv").read_bytes())]
    looks = [(at, partial(scan_world, world, Sensor(36, 2.0, 20), at)) for at in path]
    state = write_map(timed_steps(looks, options), len(looks), tmp_path, Extras())
    read, live = read_folder(tmp_path), Atlas(replace(state, position=None))
    zones = list(state.graph.nodes)
    assert len(zones) >= 5
    for zone in zones:
        question = f'what is unexplored in "{zone}"'
        assert answer(read.atlas, question) == answer(live, question)
    for one, other in permutations(zones, 2):
        request = RouteRequest(start=Place(one), goals=(Place(other),), radius=0.1)
        (there,), (here,) = (find_routes(atlas, request) for atlas in (read.atlas, live))
        assert there.zones == here.zones
        assert there.length == pytest.approx(here.length)
        assert there.path is not None
        assert here.path is not None
        assert there.path.length == pytest.approx(here.path.length)


def test_a_doorway_that_became_part_of_another_hides_none(whole: Path, tmp_path: Path) -> None:
    """Numbers are not used again: after one is gone there may be others."""
    collection = orjson.loads((whole / "doorways.geojson").read_bytes())
    first = next(it for it in collection["features"] if it["properties"]["number"] == 0)
    first["properties"]["number"] = 2
    ends = first["properties"]["ends"]
    for name in ("zones.geojson", "graph.json"):
        (tmp_path / name).write_bytes((whole / name).read_bytes())
    (tmp_path / "doorways.geojson").write_bytes(orjson.dumps(collection))
    doorways = read_folder(tmp_path).atlas.state.metric.doorways
    assert (*ends, 2) in {door.key for door in doorways.between(*ends)}


@pytest.mark.parametrize(
    ("file", "content"),
    [
        ("borders.geojson", b"{}"),
        ("borders.geojson", b'{"features": [{"properties": {"occupancy": "free"}}]}'),
        ("borders.geojson", line("C", "fog", "[[0, 0], [1, 1]]")),
        ("borders.geojson", line("nowhere", "free", "[[0, 0], [1, 1]]")),
        ("borders.geojson", line("C", "free", "[[0, 0], [1]]")),
        ("borders.geojson", line("C", "free", "[]")),
        ("doorways.geojson", b'{"features": [1]}'),
        ("doorways.geojson", b'{"features": [{"properties": {"ends": ["A", "C"]}}]}'),
        ("doorways.geojson", door("1000000000000")),
        ("doorways.geojson", door('"x"')),
    ],
)
def test_borders_and_doorways_that_are_none(bare: Path, file: str, content: bytes) -> None:
    (bare / file).write_bytes(content)
    with pytest.raises(InvalidMapError, match=file):
        read_folder(bare)


def test_the_command_finds_paths_for_a_robot(whole: Path) -> None:
    for more, status, told_ in (
        (["--radius", "0.1"], 0, "m long."),
        (["--radius", "0.1", "--json"], 0, '"clearance":'),
        (["--radius", "3"], 2, "and must be 6.000 m."),
        (["--radius", "-1"], 2, "radius must be 0 to 100 m"),
        (["--two-way"], 0, "2 passages."),
    ):
        command = [str(SEMTOPO), "route", str(whole), "path from A to C", *more]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert done.returncode == status
        assert told_ in done.stdout + done.stderr


def test_the_command_answers_and_refuses(whole: Path) -> None:
    for question, status, out, err in (
        ("what is next to C?", 0, "Next to C is corridor", ""),
        ("what is unexplored in C", 0, "Unexplored in C: ", ""),
        ("path from C to kitchen", 2, "", "semtopo: The map knows nothing by the name"),
    ):
        command = [str(SEMTOPO), "route", str(whole), question]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert done.returncode == status
        assert (done.stdout[: len(out)], done.stderr[: len(err)]) == (out, err)
        assert done.stdout.count("\n") + done.stderr.count("\n") == 1
