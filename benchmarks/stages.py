"""The stages of one step on the paper's scenario (its Table 1), and how near that is to the floor.

The floor is a plain C loop that measures and judges all samples, and one GEOS union of the two
polygons that meet: what is known of the zone where the robot is, and what is seen of it.
"""

from __future__ import annotations

import ctypes
import shutil
import statistics
import subprocess
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import shapely

from benchmarks.paper import path, world
from benchmarks.table import Row, Table
from semtopo import MappingOptions, MapState, Sensor, Stage, extract, scan_world, step
from semtopo.types import Sensing

ROUNDS = 7
BEAMS = (36, 72, 180, 360)
PAPER = {  # ms; Matlab 2019b on a Threadripper 1920X
    Stage.MEASUREMENT: (25.7, 33.5, 29.0, 1.0),
    Stage.ANALYSIS: (27.8, 41.0, 33.8, 3.2),
    Stage.EXTRACTION: (1.6, 3.7, 2.5, 0.6),
    Stage.MAP_UPDATE: (1.8, 10.6, 5.9, 1.8),
    Stage.GRAPH_UPDATE: (0.9, 2.6, 1.4, 0.6),
}
PAPER_TOTAL = (62.9, 82.9, 72.8, 4.0)
MINIMAL = 0.02
"""m; to this tolerance the polygons of the floor are minimal."""

C_LOOP = r"""
#include <math.h>
int sense(int n, const double *low, const double *high, const int *kind, const int *label,
          int beams, int samples, double range, double px, double py, int *kept) {
    int count = 0;
    for (int i = 0; i < beams; i++) {
        double a = 2 * M_PI * i / beams, dx = sin(a), dy = cos(a);
        int before_kind = 2, before_label = -1;
        for (int j = 1; j <= samples; j++) {
            double r = j * range / samples, x = px + r * dx, y = py + r * dy;
            int k = 2, l = -1;
            for (int z = n - 1; z >= 0; z--)
                if (x >= low[2*z] && x <= high[2*z] && y >= low[2*z+1] && y <= high[2*z+1]) {
                    k = kind[z]; l = label[z]; break;
                }
            if (j == 1) { if (k == 2) break; }
            else if (k == 2) { if (before_kind == 0) kept[count++] = i * samples + j - 1; break; }
            else if ((k == 1) != (before_kind == 1) || (k == 0 && l != before_label)) {
                if (before_kind == 0) kept[count++] = i * samples + j - 1;
                if (k == 0) kept[count++] = i * samples + j;
            } else if (j == samples && k == 0) kept[count++] = i * samples + j;
            before_kind = k; before_label = l;
        }
    }
    return count;
}
"""


def timed_run(beams: int, options: MappingOptions) -> dict[str, list[float]]:
    """Return how long each stage of each step takes, in ms: the least of several runs."""
    sensor, rounds = Sensor(beams, 2.0, 20), []
    for _ in range(ROUNDS):
        state, rows = MapState(), []
        for position in path():
            marks = [time.perf_counter()]

            def ended(_: Stage, marks: list[float] = marks) -> None:
                marks.append(time.perf_counter())

            scan = scan_world(world(), sensor, position, ended, sensing=options.sensing)
            state = step(state, scan, options, ended).state
            rows.append(np.diff(marks) * 1000)
        rounds.append(rows)
    least = np.min(rounds, axis=0)
    stages = {stage.value: least[:, number].tolist() for number, stage in enumerate(Stage)}
    return {**stages, "total": least.sum(axis=1).tolist()}


def c_loop_ms(beams: int) -> float | None:
    """Return what the C loop takes a step, in ms; `None` where no C compiler is."""
    compiler = shutil.which("cc")
    if compiler is None:
        return None
    with tempfile.TemporaryDirectory() as folder:
        source, library = Path(folder) / "sense.c", Path(folder) / "sense.so"
        source.write_text(C_LOOP)
        command = [compiler, "-O2", "-shared", "-fPIC", str(source), "-o", str(library), "-lm"]
        subprocess.run(command, check=True)  # noqa: S603 -- the system's compiler, on our own text
        sense = ctypes.CDLL(str(library)).sense
    zones = world().zones
    low, high = (np.array([getattr(it, end) for it in zones]) for end in ("low", "high"))
    kind = np.array([it.kind for it in zones], dtype=np.intc)
    label = np.array([world().labels.index(it.label) for it in zones], dtype=np.intc)
    kept = np.empty(beams * 20 * 2, dtype=np.intc)
    tables = [ctypes.c_void_p(it.ctypes.data) for it in (low, high, kind, label)]
    reach = ctypes.c_double(2.0)
    times = []
    for _ in range(ROUNDS):
        begun = time.perf_counter()
        for x, y in path():
            place = (ctypes.c_double(x), ctypes.c_double(y))
            sense(len(zones), *tables, beams, 20, reach, *place, ctypes.c_void_p(kept.ctypes.data))
        times.append((time.perf_counter() - begun) * 1000 / len(path()))
    return min(times)


def union_ms(beams: int, tolerance: float) -> float:
    """Return what one GEOS union of the two polygons takes a step, in ms.

    With a tolerance in m, both are simplified to it before.
    """
    options, sensor, state, times = MappingOptions(), Sensor(beams, 2.0, 20), MapState(), []
    for position in path():
        scan = scan_world(world(), sensor, position)
        seen = extract(scan, options)
        known = None if seen.here is None else state.metric.zones.get(seen.here)
        if known is not None:
            (mine,) = (zone.region for zone in seen.zones if zone.label == seen.here)
            one, other = (shapely.simplify(it, tolerance) for it in (known.region, mine))
            rounds = []
            for _ in range(ROUNDS):
                begun = time.perf_counter()
                shapely.union(one, other)
                rounds.append(time.perf_counter() - begun)
            times.append(min(rounds) * 1000)
        state = step(state, scan, options).state
    return statistics.mean(times)


def tables() -> Iterator[Table]:
    """Yield Table 1, with samples and exact, and the distance from the floor."""
    means: dict[tuple[int, Sensing], float] = {}
    for sensing in Sensing:
        for beams in BEAMS:
            runs = timed_run(beams, MappingOptions(sensing=sensing))
            means[beams, sensing] = statistics.mean(runs["total"])
            yield f"Table 1: {beams} beams, {sensing}; ms a step", _stage_rows(runs)
    rows = []
    for beams in BEAMS:
        loop = c_loop_ms(beams)
        for name, tolerance in (("as they are", 0.0), (f"simplified to {MINIMAL} m", MINIMAL)):
            floor = union_ms(beams, tolerance) + (loop or 0.0)
            rows.append({
                "beams": str(beams), "polygons": name,
                "C loop": "no compiler" if loop is None else f"{loop:.3f}",
                "C loop + union": f"{floor:.3f}",
                **{it.value: f"{means[beams, it]:.3f}" for it in Sensing},
                **{f"{it.value} / floor": f"{means[beams, it] / floor:.1f}" for it in Sensing},
            })  # fmt: skip
    yield "The floor; ms a step", rows


def _stage_rows(runs: dict[str, list[float]]) -> list[Row]:
    paper = {**{stage.value: figures for stage, figures in PAPER.items()}, "total": PAPER_TOTAL}
    return [
        {
            "stage": name, "min": f"{min(times):.3f}", "max": f"{max(times):.3f}",
            "mean": f"{statistics.mean(times):.3f}", "std": f"{statistics.pstdev(times):.3f}",
            "the paper's, another machine: min": f"{paper[name][0]:.1f}",
            "max ": f"{paper[name][1]:.1f}", "mean ": f"{paper[name][2]:.1f}",
            "std ": f"{paper[name][3]:.1f}",
        }
        for name, times in runs.items()
    ]  # fmt: skip
