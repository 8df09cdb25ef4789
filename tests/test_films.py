"""Frames and animations: a picture for each change of the graph, all of the same stretch."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest
from PIL import Image, ImageSequence

from semtopo.graph import NodeFound
from semtopo.mapper import MapState, Step
from service.films import MOMENTS_MAX, Film
from tests.test_cli import PATH, WORLD, Done, semtopo

CHANGES = [1, 5, 7, 29, 42, 43, 66, 74, 75]


def words(picture: Path) -> list[str]:
    root = ET.parse(picture).getroot()  # noqa: S314 -- our own picture
    return [it.text or "" for it in root.iter("{http://www.w3.org/2000/svg}text")]


@pytest.fixture(scope="module")
def filmed(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Done]:
    """Give a folder with frames, where there were some before, and an animation beside it."""
    folder = tmp_path_factory.mktemp("film")
    frames = folder / "frames"
    frames.mkdir()
    (frames / "step-0003.svg").write_text("old")
    (frames / "mine.svg").write_text("kept")
    done = semtopo("map", WORLD, PATH, "--beams", "36", "--out", folder, "--frames", "svg",
                   "--animation", folder / "drive.gif")  # fmt: skip
    return folder, done


def test_there_is_a_frame_for_each_change(filmed: tuple[Path, Done]) -> None:
    folder, done = filmed
    assert (done.returncode, done.stderr) == (0, "")
    frames = sorted(file.name for file in (folder / "frames").iterdir())
    assert frames == ["mine.svg", *(f"step-{seq:04d}.svg" for seq in CHANGES)]
    assert (folder / "frames/mine.svg").read_text() == "kept"


def test_a_frame_says_what_is_new(filmed: tuple[Path, Done]) -> None:
    frame = words(filmed[0] / "frames/step-0029.svg")
    assert "Step 29: zone C, passage C \u2192 corridor" in frame
    assert "29 steps, 3 zones, 3 passages" in frame
    assert "B" not in frame


def test_all_frames_show_the_same_stretch(filmed: tuple[Path, Done]) -> None:
    frames = [filmed[0] / f"frames/step-{seq:04d}.svg" for seq in CHANGES]
    ticks = {tuple(word for word in words(frame) if word.isdigit()) for frame in frames}
    sizes = {ET.parse(frame).getroot().get("viewBox") for frame in frames}  # noqa: S314 -- our own
    assert len(ticks) == len(sizes) == 1


def test_an_animation_shows_the_drive(filmed: tuple[Path, Done]) -> None:
    with Image.open(filmed[0] / "drive.gif") as film:
        assert (film.format, film.size) == ("GIF", (1280, 720))
        assert len(list(ImageSequence.Iterator(film))) == 81
        assert film.info["loop"] == 0
        film.seek(0)
        first = film.convert("RGB").tobytes()
        film.seek(80)
        assert film.convert("RGB").tobytes() != first


def test_frames_and_animations_in_other_forms(tmp_path: Path) -> None:
    (tmp_path / "path.csv").write_text("x,y\n1,6\n1.0,6.5\n")
    done = semtopo("map", WORLD, tmp_path / "path.csv", "--out", tmp_path / "map",
                   "--frames", "png", "--animation", tmp_path / "drive.webp")  # fmt: skip
    assert done.returncode == 0, done.stderr
    with Image.open(tmp_path / "map/frames/step-0001.png") as frame:
        assert (frame.format, frame.size) == ("PNG", (1280, 720))
    with Image.open(tmp_path / "drive.webp") as film:
        assert film.format == "WEBP"


@pytest.mark.parametrize(
    ("options", "line"),
    [
        (["--animation", "drive.mp4"], "semtopo: an animation is a .gif or a .webp\n"),
        (["--animation", "nowhere/drive.gif"],
         "semtopo: nowhere/drive.gif: No such file or directory\n"),
        (["--frames", "bmp"],
         "semtopo: Invalid value for '--frames': Value error, 'bmp' is not one of 'svg', 'png'.\n"),
    ],
)  # fmt: skip
def test_what_cannot_be_written_is_refused(
    tmp_path: Path, options: list[str], line: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "path.csv").write_text("x,y\n1,6\n")
    done = semtopo("map", WORLD, "path.csv", "--out", "map", *options)
    assert (done.returncode, done.stderr) == (2, line)
    assert not Path("map").exists()


def test_without_the_extra_an_animation_is_refused(tmp_path: Path) -> None:
    code = (
        "import sys; sys.modules['PIL'] = None; sys.modules['PIL.Image'] = None;"
        "from service.cli import main; main()"
    )
    command = [*map(str, ("map", WORLD, PATH, "--out", tmp_path / "map")), "--animation", "a.gif"]
    done = subprocess.run(
        [sys.executable, "-c", code, *command], capture_output=True, text=True, check=False
    )
    assert done.returncode == 2
    assert done.stderr == "semtopo: an animation needs: pip install semtopo[animation]\n"
    assert not (tmp_path / "map").exists()


def test_a_film_of_a_long_drive_has_not_too_many_pictures() -> None:
    found = (NodeFound("a", "a"),)
    for steps in (1, MOMENTS_MAX, 5_003):
        film = Film(steps)
        for seq in range(1, steps + 1):
            film.note(Step(MapState(seq=seq), None, found if seq % 2 else ()))
        assert film.moments[-1].state.seq == steps
        assert len(film.moments) <= 2 * MOMENTS_MAX + 1
        changes = [moment for moment in film.moments if moment.events]
        assert len(changes) == min(MOMENTS_MAX, -(-steps // 2))
