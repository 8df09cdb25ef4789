"""The paper's algorithms as a plain Octave program (`algorithms.m`) on the paper's scenario.

Its zones and edges must be ours, or it is no peer. Of each step counts the least time of some
rounds, as for ours. Left out where there is no Octave with its package `geometry` (Debian: `octave
octave-geometry`), which brings the union of polygons.
"""

from __future__ import annotations

import math
import shutil
import statistics
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import TypedDict

import orjson

from benchmarks import stages
from benchmarks.paper import EXAMPLE, path, world
from benchmarks.table import Table, skipped
from semtopo import MappingOptions, MapState, Sensor, explore
from semtopo.types import Point

PROGRAM = Path(__file__).with_name("algorithms.m")
BEAMS = (72, 360)
ROUNDS = 2
STEPS = 81


class Found(TypedDict):
    """What the program prints."""

    times: list[list[float]]
    """s; for each step what each stage took: the least of the rounds."""
    nodes: list[str]
    areas: list[float]
    """m^2, of the nodes' zones."""
    sources: list[str]
    targets: list[str]
    points: list[Point]


class DifferentMapError(Exception):
    """The peer's map is not ours."""


def missing() -> str | None:
    """Return what is not there of what the program needs, if anything."""
    if shutil.which("octave-cli") is None:
        return "no octave-cli found"
    command = ["octave-cli", "--no-init-file", "--quiet", "--eval", "pkg load geometry"]
    loaded = subprocess.run(command, capture_output=True, check=False)  # noqa: S603 -- the system's
    return None if loaded.returncode == 0 else "Octave has no package geometry"


def by_octave(beams: int) -> Found:
    """Run the program."""
    files = [str(EXAMPLE / "world.json"), str(EXAMPLE / "path.csv")]
    numbers = map(str, (beams, 2.0, 20, STEPS, ROUNDS))
    command = ["octave-cli", "--no-init-file", "--quiet", str(PROGRAM), *files, *numbers]
    done = subprocess.run(command, capture_output=True, check=True)  # noqa: S603 -- the system's
    found: Found = orjson.loads(done.stdout)
    return found


def check(found: Found, beams: int) -> None:
    """See that the program's map is ours; raises DifferentMapError.

    Points of edges may differ, but not in how far they are from the robot: on a circle of ends of
    sight many are the nearest up to rounding.
    """
    state, sensor, options = MapState(), Sensor(beams, 2.0, 20), MappingOptions()
    for taken in explore(world(), sensor, path()[:STEPS], options):
        state = taken.state
    areas = dict(zip(found["nodes"], found["areas"], strict=True))
    ours = {zone.zone_id: zone.region.area for zone in state.metric.zones.values()}
    ends = zip(found["sources"], found["targets"], found["points"], strict=True)
    points = {(source, target, 0): (x, y) for source, target, (x, y) in ends}
    if list(areas) != list(ours) or list(points) != list(state.graph.passages):
        raise DifferentMapError(f"other nodes or edges: {list(areas)}, {list(points)}")
    for name, area in areas.items():
        if not math.isclose(area, ours[name], rel_tol=1e-9):
            raise DifferentMapError(f"{name} has {area} m^2, not {ours[name]}")
    for key, passage in state.graph.passages.items():
        robot = path()[passage.seq - 1]
        way, our_way = math.dist(robot, points[key]), math.dist(robot, passage.point)
        if not math.isclose(way, our_way, rel_tol=1e-9):
            raise DifferentMapError(f"the point of {key} is {way} m away, not {our_way}")


def compared(beams: int) -> Table:
    """Return the table of one sensor."""
    found = by_octave(beams)
    check(found, beams)
    times = dict(zip(stages.PAPER, zip(*found["times"], strict=True), strict=True))
    theirs = {stage.value: 1000 * statistics.mean(took) for stage, took in times.items()}
    theirs["total"] = sum(theirs.values())
    runs = stages.timed_run(beams, MappingOptions())
    rows = []
    for stage, took in theirs.items():
        mine = statistics.mean(runs[stage][:STEPS])
        rows.append({
            "stage": stage, "Octave": f"{took:.2f}", "semtopo": f"{mine:.3f}",
            "times ours": f"{took / mine:.0f}",
        })  # fmt: skip
    return f"Algorithms 1-3 in Octave, {beams} beams; mean, ms a step", rows


def tables() -> Iterator[Table]:
    """Yield the stages of a step beside Octave's."""
    reason = missing()
    if reason is not None:
        yield skipped("Algorithms 1-3 in Octave", reason)
        return
    yield from map(compared, BEAMS)
