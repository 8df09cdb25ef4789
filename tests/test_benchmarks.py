"""The benchmarks run, on a small scale, and their peers do what they should."""

from __future__ import annotations

import importlib
import pathlib
import shutil
import subprocess
import sys
from random import Random

import orjson
import pytest
from shapely import Polygon

from benchmarks import __main__ as command
from benchmarks import dense_paths, growth, octave, proved_paths, routes, stages, worlds
from benchmarks.paper import path, wander, world
from semtopo import MappingOptions, Sensor, explore
from semtopo.errors.ways import NotConnectedError
from semtopo.freespace import FreeSpace, Path
from semtopo.types import Sensing
from tests.visibility import ShortestWays

SMALL: dict[str, dict[str, object]] = {
    "stages": {"ROUNDS": 1, "BEAMS": (36,)},
    "octave": {"ROUNDS": 1, "BEAMS": (36,), "STEPS": 8},
    "growth": {"STEPS": 120, "MARKS": (110, 120)},
    "worlds": {"SIZES": (10, 100), "STEPS": 20, "ROUNDS": 1},
    "routes": {"SIDE": 6, "QUERIES": 5},
    "dense_paths": {"COMPARED": (50,), "GROWING": (50,)},
    "proved_paths": {"QUERIES": 90},
    "http_steps": {"ROUNDS": 2, "STEPS": 5, "LAYOUTS": ((1, 2, "together"), (2, 2, "apart"))},
    "durable_step": {"ROUNDS": 2, "COUNT": {2: 20}},
    "reading": {"READS": 20, "ROUNDS": 1, "ROOMS": 9},
    "memory": {"TOLERANCES": (0.02,), "STEPS": 60, "WARM_STEPS": 5},
    "many_sessions": {"SESSIONS": 5, "STEPS": 40},
}
"""For each module what makes it quick."""


def test_every_module_is_measured_here() -> None:
    files = pathlib.Path(command.__file__).parent.glob("*.py")
    measuring = {it.stem for it in files if "\ndef tables(" in it.read_text()}
    assert measuring == set(command.MODULES) == set(SMALL)


@pytest.mark.parametrize("name", SMALL)
def test_tables_are_printed_and_written(
    name: str,
    tmp_path: pathlib.Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    module = importlib.import_module(f"benchmarks.{name}")
    for constant, value in SMALL[name].items():
        monkeypatch.setattr(module, constant, value)
    out = tmp_path / "new" / "bench.json"
    monkeypatch.setattr(sys, "argv", ["benchmarks", name, "--out", str(out), "--peers", "none"])
    monkeypatch.setattr(sys, "path", [*sys.path])
    command.main()
    tables = orjson.loads(out.read_bytes())
    printed = capsys.readouterr().out
    assert tables
    for title, rows in tables.items():
        assert title in printed
        assert rows
        assert all(list(row) == list(rows[0]) for row in rows)
        assert all(isinstance(cell, str) for row in rows for cell in row.values())


def test_a_table_tells_which_peers_are_not_there(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(routes, "SIDE", 5)
    monkeypatch.setattr(routes, "QUERIES", 2)
    monkeypatch.setattr(routes, "is_there", lambda module: module == "networkx")
    monkeypatch.setattr(dense_paths, "is_there", lambda _: False)
    ((_, rows),) = routes.tables()
    told = {row["who"]: row["median ms"] for row in rows}
    assert told.pop("rustworkx, Dijkstra").startswith("not installed on Python 3.")
    assert all(float(milliseconds) > 0 for milliseconds in told.values())
    _, rows = dense_paths.peers_table(50)
    absent = [row["who"] for row in rows if row["ms"].startswith("not installed")]
    assert absent == ["extremitypathfinder", "pyvisgraph"]


PEERS = pathlib.Path(sys.prefix) / "peers"


@pytest.mark.skipif(not PEERS.exists(), reason=f"{PEERS} is not there; `make peers` makes it")
def test_every_peer_finds_what_we_find(tmp_path: pathlib.Path) -> None:
    """In a process of its own, since one of them brings a package `tests`."""
    program = (
        "import sys; from benchmarks import __main__, dense_paths, routes\n"
        "dense_paths.COMPARED, dense_paths.GROWING = (50,), (50,)\n"
        "routes.SIDE, routes.QUERIES = 5, 3\n"
        "__main__.main()"
    )
    out = tmp_path / "bench.json"
    command_line = [sys.executable, "-c", program, "routes", "dense_paths", "--out", str(out)]
    root = pathlib.Path(command.__file__).parents[1]
    subprocess.run(command_line, cwd=root, check=True, capture_output=True)
    on_grid, of_peers, _ = orjson.loads(out.read_bytes()).values()
    assert all(float(row["median ms"]) > 0 for row in on_grid)
    assert len(on_grid) == 3 + len(routes.PEERS)
    assert len(of_peers) == 1 + len(dense_paths.PEERS)
    assert len({row["length m"] for row in of_peers}) == 1


def test_table_1_has_every_stage_and_its_total(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stages, "ROUNDS", 1)
    runs = stages.timed_run(36, MappingOptions())
    assert list(runs) == [*stages.PAPER, "total"]
    assert all(len(times) == len(path()) for times in runs.values())
    assert sum(runs["total"]) == pytest.approx(sum(sum(runs[stage]) for stage in stages.PAPER))


@pytest.mark.skipif(shutil.which("cc") is None, reason="the floor needs a C compiler")
def test_the_floor_is_measured(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stages, "ROUNDS", 1)
    loop = stages.c_loop_ms(36)
    assert loop is not None
    assert 0 < loop < 50
    assert stages.union_ms(36, stages.MINIMAL) > 0


def their_map(beams: int, steps: int) -> octave.Found:
    """Return what a peer without a fault would print."""
    *_, last = explore(world(), Sensor(beams), path()[:steps])
    zones, passages = last.state.metric.zones, last.state.graph.passages.values()
    return {
        "times": [], "nodes": list(zones), "areas": [it.region.area for it in zones.values()],
        "sources": [it.source for it in passages], "targets": [it.target for it in passages],
        "points": [it.point for it in passages],
    }  # fmt: skip


def test_a_peer_with_another_map_is_no_peer(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(octave, "STEPS", 8)
    found = their_map(36, 8)
    octave.check(found, 36)
    x, y = found["points"][0]
    wrong: list[tuple[octave.Found, str]] = [
        ({**found, "areas": [found["areas"][0] + 1e-6, *found["areas"][1:]]}, r"m\^2, not"),
        ({**found, "points": [(x, y + 1e-3), *found["points"][1:]]}, "m away, not"),
        ({**found, "sources": found["targets"]}, "other nodes or edges"),
    ]
    for other, why in wrong:
        with pytest.raises(octave.DifferentMapError, match=why):
            octave.check(other, 36)


@pytest.mark.parametrize(
    ("length", "best", "told"),
    [
        (1.0, 1.0, []),
        (1.0, 1.001, ["shorter than can be"]),
        (1.0, None, ["shorter than can be"]),
        (1.005, 1.0, ["longer at all"]),
        (1.02, 1.0, ["longer at all", "over 1 % longer"]),
    ],
)
def test_lengths_are_judged(length: float, best: float | None, told: list[str]) -> None:
    assert list(proved_paths.compared(length, best)) == told


def test_faults_of_paths_are_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    space = FreeSpace(Polygon([(0, 0), (9, 0), (9, 9), (0, 9)], [[(1, 1), (8, 1), (8, 8), (1, 8)]]))
    ways = ShortestWays(space.inset)
    monkeypatch.setattr(proved_paths, "ends", lambda *_: ((0.5, 4.0), (8.5, 4.0)))

    def told() -> set[str]:
        return set(proved_paths.judged(space, ways, Random(0))) & set(proved_paths.FAULTS)

    assert told() == set()
    straight = Path(((0.5, 4.0), (8.5, 4.0)), 8.0, 0.0)
    monkeypatch.setattr(FreeSpace, "path", lambda *_: straight)
    assert told() == {"outside free space", "shorter than can be"}

    def refuse(*_: object) -> Path:
        raise NotConnectedError("no way")

    monkeypatch.setattr(FreeSpace, "path", refuse)
    assert told() == {"wrongly refused"}


def test_growth_is_measured_on_the_same_walk(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(growth, "STEPS", 150)
    monkeypatch.setattr(growth, "MARKS", (100, 150))
    whole, reduced = growth.run(0.0), growth.run(0.02)
    assert len(whole[0]) == len(reduced[0]) == 150
    assert growth.vertices(reduced[1][150]) < growth.vertices(whole[1][150]) / 5
    assert 0 < growth.differing(reduced[1][150], whole[1][150], 0.02) < 1


def test_a_wandering_robot_stays_in_free_space() -> None:
    walk = wander(200)
    assert len(walk) == 200
    *_, last = explore(worlds.floor(10), Sensor(36), worlds.walk(worlds.floor(10)))
    assert len(last.state.metric.zones) >= 2


@pytest.mark.parametrize("sensing", Sensing)
def test_worlds_of_all_sizes_lead_to_the_same_map(sensing: Sensing) -> None:
    options = MappingOptions(sensing=sensing)
    maps = []
    for zones in (10, 100, 1_000):
        world = worlds.floor(zones)
        assert len(world.zones) == zones
        *_, last = explore(world, Sensor(36), worlds.walk(world), options)
        maps.append(last.state)
    areas = [[zone.region.area for zone in it.metric.zones.values()] for it in maps]
    assert len(areas[0]) == 3
    assert areas[1:] == [pytest.approx(areas[0])] * 2
    assert len({len(it.graph.passages) for it in maps}) == 1


@pytest.mark.parametrize("sensing", Sensing)
def test_a_walk_through_a_large_world_is_timed(
    monkeypatch: pytest.MonkeyPatch, sensing: Sensing
) -> None:
    monkeypatch.setattr(worlds, "ROUNDS", 1)
    total, sensed = worlds.timed(worlds.floor(1_000), sensing)
    assert 0 < sensed < total
