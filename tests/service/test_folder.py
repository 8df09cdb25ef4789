"""A folder that `semtopo map` wrote answers what it can, and says what it does not know."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from semtopo.answers import answer
from semtopo.errors import InvalidMapError, SemtopoError
from semtopo.errors.ways import NoRouteError
from service.folder import read_folder
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
    """Give a folder without the steps."""
    for name in ("zones.geojson", "graph.json"):
        (tmp_path / name).write_bytes((whole / name).read_bytes())
    return tmp_path


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
        ("what is unexplored in C", "unknown_border: The map holds no borders"),
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


@pytest.mark.parametrize("lines", [b"x", b"[]", b'{"seq": 1}', b"\xff"])
def test_steps_that_are_none(bare: Path, lines: bytes) -> None:
    (bare / "steps.jsonl").write_bytes(lines)
    with pytest.raises(InvalidMapError, match=r"steps\.jsonl: a line is"):
        read_folder(bare)


def test_steps_that_say_nothing_of_this_map(bare: Path) -> None:
    (bare / "steps.jsonl").write_bytes(b'{"here": "nowhere"}\n' * 81)
    assert told(bare, "where am I").startswith("unknown_position")


def test_no_frontier_is_named_where_none_is_known(tmp_path: Path) -> None:
    read = read_folder(written(tmp_path, 29))
    with pytest.raises(NoRouteError, match="C -> corridor has been since step 29") as refused:
        answer(read.atlas, "path from corridor to C", read.history)
    assert refused.value.frontier is None
    assert "frontier" not in str(refused.value)


def test_the_command_answers_and_refuses(whole: Path) -> None:
    for question, status, out, err in (
        ("what is next to C?", 0, "Next to C is corridor", ""),
        ("what is unexplored in C", 2, "", "semtopo: The map holds no borders"),
    ):
        command = [str(SEMTOPO), "route", str(whole), question]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert done.returncode == status
        assert (done.stdout[: len(out)], done.stderr[: len(err)]) == (out, err)
        assert done.stdout.count("\n") + done.stderr.count("\n") == 1
