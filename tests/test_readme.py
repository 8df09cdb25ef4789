"""What the README shows must run."""

import re
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree as ET

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")


def blocks(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", README, re.MULTILINE | re.DOTALL)


def test_library_example_runs() -> None:
    (example,) = blocks("python")
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", example],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    lines = done.stdout.splitlines()
    assert lines[0] == "1 corridor NodeFound(label='corridor', zone_id='corridor')"
    assert lines[-1].startswith("Leave corridor at (8.9, 4.3) into C")


def test_links_and_pictures_exist() -> None:
    targets = re.findall(r"\]\(([^)]+)\)", README)
    assert targets
    assert [target for target in targets if not (ROOT / target).is_file()] == []


def test_picture_is_small_and_is_what_the_command_draws(tmp_path: Path) -> None:
    picture = ROOT / "docs/map.svg"
    assert picture.stat().st_size < 300_000
    example = ROOT / "examples/paper"
    subprocess.run(
        [
            Path(sys.executable).with_name("semtopo"),
            *("map", example / "world.json", example / "path.csv", "--out", tmp_path),
        ],
        check=True,
        capture_output=True,
    )
    assert structure(tmp_path / "map.svg") == structure(picture)


def structure(picture: Path) -> list[str]:
    """Give the elements of a picture; the last digits of its numbers may differ by machine."""
    return [element.tag for element in ET.parse(picture).iter()]  # noqa: S314 -- our own picture
