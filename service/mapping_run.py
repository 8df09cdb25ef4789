"""Map a whole drive into a folder: what `semtopo map` does once its arguments are understood.

In come a world with a path, or a recording, as files; out goes a folder with zones.geojson,
graph.json, borders.geojson, doorways.geojson, steps.jsonl, map.svg, and frames if asked for. The
folder changes only when all of them are complete.
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from semtopo import codec
from semtopo.errors import InvalidInputError
from semtopo.exports.geojson import borders_body, doorways_body
from semtopo.formats import count_scans, read_path, read_recording, read_world
from semtopo.mapper import MapState, Stage, Step, scan_world, step
from semtopo.render import render
from semtopo.render.drawing import Drawing, thinned_trail
from semtopo.runs import LabelledRuns, from_runs
from semtopo.scan import Scan
from semtopo.sensor import Sensor
from semtopo.types import MappingOptions, Point, Pose, Sensing
from service.films import FRAME, Film, animation_of, check_animation, write_frames
from service.painting import Form
from service.stopwatch import Stopwatch

ZONES, GRAPH, STEPS, PICTURE = "zones.geojson", "graph.json", "steps.jsonl", "map.svg"
BORDERS, DOORWAYS, FRAMES = "borders.geojson", "doorways.geojson", "frames"

Look = tuple[Point, Callable[[Callable[[Stage], None]], Scan]]
"""A position in m, and what gives the scan taken there; it is told whom to tell of its stages."""


@dataclass(frozen=True, slots=True)
class Drive:
    """The scans of a drive, one after the other, and how many there are."""

    count: int
    looks: Iterable[Look]


@dataclass(frozen=True, slots=True)
class TimedStep:
    """A step, the position in m where it was taken, and how long each stage took."""

    step: Step
    position: Point
    timings_ms: dict[str, float]


def simulated_drive(world_file: Path, path_file: Path, sensor: Sensor, sensing: Sensing) -> Drive:
    """Return the drive of a simulated robot along a path through a world."""
    with naming(world_file):
        world = read_world(world_file.read_bytes())
    with naming(path_file):
        path = read_path(path_file.read_bytes())
    look = partial(scan_world, world, sensor, sensing=sensing)
    looks = [(pose.position, partial(look, pose.position)) for pose in path]
    return Drive(len(path), looks)


def recorded_drive(scans_file: Path) -> Drive:
    """Return the drive of a real robot; its scans are read one by one, as they are needed."""
    content = scans_file.read_bytes()
    with naming(scans_file):
        count = count_scans(content)
    return Drive(count, _recorded_looks(scans_file, content))


def _recorded_looks(scans_file: Path, content: bytes) -> Iterator[Look]:
    with naming(scans_file):
        for pose, seen in read_recording(content):
            yield pose.position, partial(_recorded_scan, pose, seen)


def _recorded_scan(pose: Pose, seen: LabelledRuns, ended: Callable[[Stage], None]) -> Scan:
    scan = from_runs(pose, seen)
    ended(Stage.ANALYSIS)  # nothing was measured here
    return scan


@contextmanager
def naming(file: Path) -> Iterator[None]:
    """Begin the text of an error about input with the file that it came from."""
    try:
        yield
    except InvalidInputError as error:
        raise type(error)(f"{file}: {error}") from None


def timed_steps(looks: Iterable[Look], options: MappingOptions) -> Iterator[TimedStep]:
    """Take the scans of a drive into an empty map one by one (Alg. 1), and time each step."""
    state = MapState()
    for position, look in looks:
        watch = Stopwatch()
        taken = step(state, look(watch.ended), options, watch.ended)
        yield TimedStep(taken, position, watch.timings_ms())
        state = taken.state


@dataclass(frozen=True, slots=True)
class Extras:
    """What is written beside a map: pictures of its changes, and an animation of the drive.

    Raises
    ------
    InvalidOptionError
        The animation cannot be written, here or at all.
    """

    frames: Form | None = None
    animation: Path | None = None

    def __post_init__(self) -> None:
        """Refuse an animation that cannot be written."""
        if self.animation is not None:
            check_animation(self.animation)

    def write(self, film: Film, path: list[Point], folder: Path) -> None:
        """Write the frames into a folder below, and the animation to its file."""
        if self.frames is not None:
            (folder / FRAMES).mkdir()
            write_frames(film, path, folder / FRAMES, self.frames)
        if self.animation is not None and film.moments:
            content = animation_of(film, path, self.animation.suffix)
            self.animation.write_bytes(content)


def write_map(steps: Iterable[TimedStep], count: int, directory: Path, extras: Extras) -> MapState:
    """Take all steps, write the files of their map into a folder, and return the map."""
    state, path, lines, film = MapState(), [], [], Film(count)
    with replaced_together(directory) as folder:
        for taken in steps:
            state = taken.step.state
            path.append(taken.position)
            lines.append(_step_line(taken))
            if extras != Extras():
                film.note(taken.step)
        (folder / ZONES).write_bytes(codec.zones_body(state))
        (folder / GRAPH).write_bytes(codec.graph_body(state.graph, state.seq))
        (folder / BORDERS).write_bytes(borders_body(state))
        (folder / DOORWAYS).write_bytes(doorways_body(state))
        (folder / STEPS).write_bytes(b"".join(lines))
        extras.write(film, path, folder)
        (folder / PICTURE).write_text(
            render(state, Drawing(trail=thinned_trail(path))), encoding="utf-8"
        )
    return state


def _step_line(taken: TimedStep) -> bytes:
    document = {**codec.step_document(taken.step), "timings_ms": taken.timings_ms}
    return codec.to_json(document) + b"\n"


@contextmanager
def replaced_together(directory: Path) -> Iterator[Path]:
    """Give an empty folder; if all went well, its files move into `directory`, else they vanish.

    `directory` is made if need be. That it cannot be written to comes out at once.
    """
    is_new = not directory.exists()
    directory.mkdir(parents=True, exist_ok=True)
    try:
        with tempfile.TemporaryDirectory(prefix=".semtopo-", dir=directory) as name:
            folder = Path(name)
            yield folder
            _move_all(folder, directory)
    except BaseException:
        if is_new:
            with suppress(OSError):
                directory.rmdir()
        raise


def _move_all(folder: Path, directory: Path) -> None:
    """Move files into a directory, and frames into one below it, from which older ones vanish."""
    frames = directory / FRAMES
    if (folder / FRAMES).is_dir():
        frames.mkdir(exist_ok=True)
        for old in frames.iterdir():
            if FRAME.fullmatch(old.name):
                old.unlink()
    for file in sorted(file for file in folder.rglob("*") if file.is_file()):
        os.replace(file, directory / file.relative_to(folder))  # noqa: PTH105 -- replaces atomically
