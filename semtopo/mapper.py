"""The main program (Alg. 1): from step to step, the map and the graph grow.

In come scans; out go states `[M_m, M_s]` and what each step found. The stages are called one by
one, so that whoever has a clock can time them (Table 1); this package has none.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from enum import StrEnum

from semtopo.findings import extend
from semtopo.graph import Event, TopologyGraph
from semtopo.metric import MetricMap
from semtopo.placement import place
from semtopo.scan import Scan, analyse
from semtopo.sensor import Sensor, measure, trace
from semtopo.sensor_map import extract
from semtopo.types import MappingOptions, Point, Sensing
from semtopo.world import World


class Stage(StrEnum):
    """The stages of one step, as the paper's Table 1 names them."""

    MEASUREMENT = "measurement"
    ANALYSIS = "analysis"
    EXTRACTION = "extraction"
    MAP_UPDATE = "map_update"
    GRAPH_UPDATE = "graph_update"


def _unobserved(stage: Stage) -> None:
    """Take no notice that a stage ended."""


@dataclass(frozen=True, slots=True, eq=False)
class MapState:
    """All that is known after step `seq`: [M_m, M_s]. The initial state is empty (Alg. 1, l. 1).

    `position` is where the last step was taken, in m, map frame, and `here` the zone id of where
    the robot was then; both are `None` before the first step, and `here` where nothing was seen.
    """

    seq: int = 0
    metric: MetricMap = field(default_factory=MetricMap)
    graph: TopologyGraph = field(default_factory=TopologyGraph)
    position: Point | None = None
    here: str | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Step:
    """What one step led to: the new state, the label of the zone where the robot is, the findings.

    `here` is `None` if the scan showed no zone; the step counts all the same (R8).
    """

    state: MapState
    here: str | None
    events: tuple[Event, ...]


def scan_world(
    world: World,
    sensor: Sensor,
    position: Point,
    ended: Callable[[Stage], None] = _unobserved,
    *,
    sensing: Sensing = Sensing.SAMPLED,
) -> Scan:
    """Return what a simulated sensor sees at a position in m (Alg. 2, l. 2-34; R16).

    `ended` is called with each stage as it ends.
    """
    look = trace if sensing is Sensing.EXACT else measure
    measurement = look(world, sensor, position)
    ended(Stage.MEASUREMENT)
    scan = analyse(measurement)
    ended(Stage.ANALYSIS)
    return scan


def step(
    state: MapState,
    scan: Scan,
    options: MappingOptions,
    ended: Callable[[Stage], None] = _unobserved,
) -> Step:
    """Take one scan into the map (Alg. 1, l. 4-5).

    `ended` is called with each stage as it ends.
    """
    seq = state.seq + 1
    sensor_map = extract(scan, options)
    ended(Stage.EXTRACTION)
    placed = place(state.metric, sensor_map, options, seq)
    ended(Stage.MAP_UPDATE)
    graph, events = extend(state.graph, placed, seq, options.passages)
    ended(Stage.GRAPH_UPDATE)
    after = MapState(seq, placed.metric, graph, scan.position, placed.here)
    return Step(after, sensor_map.here, events)


def run(scans: Iterable[Scan], options: MappingOptions | None = None) -> Iterator[Step]:
    """Take scans into an empty map one by one, and yield each step (Alg. 1)."""
    chosen = options or MappingOptions()
    state = MapState()
    for scan in scans:
        taken = step(state, scan, chosen)
        yield taken
        state = taken.state


def explore(
    world: World, sensor: Sensor, path: Iterable[Point], options: MappingOptions | None = None
) -> Iterator[Step]:
    """Drive a simulated robot along a path of positions in m, and yield each step (Alg. 1)."""
    sensing = (options or MappingOptions()).sensing
    scans = (scan_world(world, sensor, position, sensing=sensing) for position in path)
    return run(scans, options)
