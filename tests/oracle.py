"""Algorithms 1-3 once more: slow, scalar, literal, written from the paper and its readings.

The tests hold the library against this. Plain loops over beams and samples, one shapely union for
each zone; nothing of `semtopo` is used but its words (kinds, occupancies, options, the classes of
what comes in).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import TypeAlias

from shapely import MultiPolygon, Polygon
from shapely import Point as Place
from shapely.geometry.base import BaseGeometry
from shapely.ops import nearest_points, unary_union

from semtopo.runs import LabelledRuns
from semtopo.sensor import Sensor
from semtopo.types import Edges, Kind, MappingOptions, Occupancy, Point, Pose
from semtopo.world import World

LINE = 1e-9  # m^2: what is smaller is a strip that fell together into a line (R6)
SAME = 1e-9  # m: distances that differ by less are ties, up to rounding


@dataclass(frozen=True)
class Sample:
    """What is at one place: u_xy without its point."""

    kind: Kind
    label: str = ""


@dataclass(frozen=True)
class KeptPoint:
    """A characteristic point: the number of its sample (from 1), and why it was kept."""

    number: int
    label: str
    occupancy: Occupancy
    opens: bool
    source: str = ""


@dataclass(frozen=True)
class Interval:
    """A piece of a beam that lies in one label (R6)."""

    label: str
    near: float
    far: float
    near_occupancy: Occupancy
    far_occupancy: Occupancy
    source: str
    from_robot: bool


@dataclass(frozen=True)
class Scan:
    """Intervals beam by beam, with the direction of each beam."""

    position: Point
    directions: list[Point]
    ring: bool
    beams: list[list[Interval]]

    def at(self, beam: int, radius: float) -> Point:
        """Return the point at a distance on a beam."""
        (x, y), (east, north) = self.position, self.directions[beam]
        return (x + radius * east, y + radius * north)


@dataclass(frozen=True)
class Strip:
    """The ground between two intervals of one label on neighbouring beams."""

    label: str
    source: str
    polygon: Polygon


Crossing: TypeAlias = tuple[str, str]
Region: TypeAlias = Polygon | MultiPolygon


@dataclass(frozen=True)
class Edge:
    """E(s_r, s_u, p_u): its point, and how far that was from the robot."""

    point: Point
    distance: float


@dataclass(frozen=True)
class SensorMap:
    """M_u, with `nearest`: every label that is nearest to the robot, up to rounding."""

    zones: dict[str, Region]
    nearest: set[str]
    entries: list[tuple[Crossing, Region]]


@dataclass
class State:
    """[M_m, M_s]."""

    zones: dict[str, Region] = field(default_factory=dict)
    nodes: list[str] = field(default_factory=list)
    edges: dict[Crossing, Edge] = field(default_factory=dict)


@dataclass(frozen=True)
class Step:
    """What a step led to: events are a label (a node) or a pair of labels (an edge)."""

    state: State
    here: str | None
    events: list[str | Crossing]


def read_map(world: World, point: Point) -> Sample:
    """ReadMap: the later rectangle wins, edges belong to it, outside is obstacle (R4)."""
    found = Sample(Kind.OBSTACLE)
    for zone in world.zones:
        inside_x = zone.low[0] <= point[0] <= zone.high[0]
        inside_y = zone.low[1] <= point[1] <= zone.high[1]
        if inside_x and inside_y:
            found = Sample(zone.kind, zone.label)
    return found


def bearings(sensor: Sensor) -> list[Point]:
    """Return the direction of each beam (Alg. 2, l. 3 and 5; R1)."""
    angles = [2 * math.pi * (i - 1) / sensor.beams for i in range(1, sensor.beams + 1)]
    return [(math.sin(angle), math.cos(angle)) for angle in angles]


def measure(world: World, sensor: Sensor, position: Point) -> list[list[Sample]]:
    """Read every sample of every beam (Alg. 2, l. 2-7)."""
    rows = []
    for east, north in bearings(sensor):
        row = []
        for j in range(1, sensor.samples + 1):
            radius = j * sensor.range / sensor.samples
            point = (position[0] + radius * east, position[1] + radius * north)
            row.append(read_map(world, point))
        rows.append(row)
    return rows


def kept_points(samples: Sequence[Sample]) -> list[KeptPoint]:  # noqa: C901 -- as the paper has it
    """Return the characteristic points of one beam (Alg. 2, l. 8-34)."""
    kept: list[KeptPoint] = []
    if samples[0].kind is Kind.OBSTACLE:  # l. 9
        return kept
    for j in range(2, len(samples) + 1):  # l. 10
        before, sample = samples[j - 2], samples[j - 1]
        if sample.kind is Kind.OBSTACLE:  # l. 11
            if before.kind is Kind.SPACE:  # R3
                kept.append(KeptPoint(j - 1, before.label, Occupancy.OBSTACLE, opens=False))
            break  # R2
        why = _why_border(before, sample)
        if why is not Occupancy.NONE:
            if before.kind is Kind.SPACE:  # l. 18-19, R5, R13
                kept.append(KeptPoint(j - 1, before.label, why, opens=False))
            if sample.kind is Kind.SPACE:  # l. 21-22, R5
                source = _source(samples, j)
                kept.append(KeptPoint(j, sample.label, why, opens=True, source=source))
        elif j == len(samples) and sample.kind is Kind.SPACE:  # l. 25-28
            kept.append(KeptPoint(j, sample.label, Occupancy.FREE, opens=False))
    return kept


def _why_border(before: Sample, sample: Sample) -> Occupancy:
    """Return what kind of border lies between two samples that are no obstacles, if any."""
    if Kind.UNKNOWN in (before.kind, sample.kind):  # R13
        return Occupancy.FREE if before.kind is not sample.kind else Occupancy.NONE
    if (before.kind is Kind.PASSAGE) != (sample.kind is Kind.PASSAGE):  # l. 16
        return Occupancy.PASSAGE
    if before.kind is Kind.SPACE and before.label != sample.label:  # R5
        return Occupancy.PASSAGE
    return Occupancy.NONE


def _source(samples: Sequence[Sample], j: int) -> str:
    """Return the label before the one passage that ends at sample j, if any (R15)."""
    back = j - 1
    while back >= 1 and samples[back - 1].kind is Kind.PASSAGE:
        back -= 1
    if back < 1 or samples[back - 1].kind is not Kind.SPACE:
        return ""
    return samples[back - 1].label


def intervals(samples: Sequence[Sample], radii: Sequence[float]) -> list[Interval]:
    """Return the intervals of one beam (R6)."""
    found: list[Interval] = []
    if samples[0].kind is Kind.SPACE:
        own, none = samples[0].label, Occupancy.NONE
        found.append(Interval(own, 0.0, radii[0], none, none, "", from_robot=True))
    for point in kept_points(samples):
        radius = radii[point.number - 1]
        if point.opens:
            near, none = point.occupancy, Occupancy.NONE
            found.append(
                Interval(point.label, radius, radius, near, none, point.source, from_robot=False)
            )
        else:
            found[-1] = replace(found[-1], far=radius, far_occupancy=point.occupancy)
    return found


def analyse(world: World, sensor: Sensor, position: Point) -> Scan:
    """Return what a simulated sensor sees."""
    radii = [j * sensor.range / sensor.samples for j in range(1, sensor.samples + 1)]
    rows = [intervals(samples, radii) for samples in measure(world, sensor, position)]
    return Scan(position, bearings(sensor), ring=True, beams=rows)


def analyse_runs(pose: Pose, seen: LabelledRuns) -> Scan:
    """Return what a real robot saw (design.md, section 5, and R13)."""
    count, step = len(seen.beams), abs(seen.angle_increment)
    angles = [pose.theta + seen.angle_min + i * seen.angle_increment for i in range(count)]
    gap = 2 * math.pi - (count - 1) * step
    return Scan(
        position=(pose.x, pose.y),
        directions=[(math.cos(angle), math.sin(angle)) for angle in angles],
        ring=0.5 * step < gap < 1.5 * step,
        beams=[_run_intervals(beam, seen) for beam in seen.beams],
    )


_BEYOND = {
    Kind.SPACE: Occupancy.PASSAGE,
    Kind.PASSAGE: Occupancy.PASSAGE,
    Kind.OBSTACLE: Occupancy.OBSTACLE,
    Kind.UNKNOWN: Occupancy.FREE,
}


def _run_intervals(beam: Sequence[tuple[str, float]], seen: LabelledRuns) -> list[Interval]:
    """Return the intervals of one beam of labelled runs."""
    merged: list[tuple[Sample, float, float]] = []
    start = 0.0
    for label, end in beam:
        sample = Sample(seen.kinds.get(label, Kind.SPACE), label)
        if merged and merged[-1][0] == sample:
            merged[-1] = (sample, merged[-1][1], end)
        else:
            merged.append((sample, start, end))
        start = end
    samples = [sample for sample, _, _ in merged]
    if merged and start < seen.range_max:
        samples.append(Sample(Kind.OBSTACLE))
    found = []
    for j, (sample, near, far) in enumerate(merged, start=1):
        if sample.kind is Kind.OBSTACLE:
            break
        if sample.kind is Kind.SPACE:
            why_near = _BEYOND[samples[j - 2].kind] if j > 1 else Occupancy.NONE
            why_far = _BEYOND[samples[j].kind] if j < len(samples) else Occupancy.FREE
            source = _source(samples, j)
            found.append(Interval(sample.label, near, far, why_near, why_far, source, j == 1))
    return found


def strips(scan: Scan) -> list[Strip]:
    """Return the strips of a scan (R6); those that are lines are none."""
    found = []
    beams = len(scan.beams)
    for i in range(beams if scan.ring else beams - 1):
        k = (i + 1) % beams
        for one in scan.beams[i]:
            for two in scan.beams[k]:
                if one.label != two.label or one.from_robot != two.from_robot:
                    continue
                if one.near > two.far or two.near > one.far:
                    continue
                corners = [
                    scan.at(i, one.near),
                    scan.at(i, one.far),
                    scan.at(k, two.far),
                    scan.at(k, two.near),
                ]
                source = one.source if one.source == two.source else ""
                if (polygon := Polygon(corners)).area > LINE:
                    found.append(Strip(one.label, source, polygon))
    return found


def extract(scan: Scan, options: MappingOptions) -> SensorMap:
    """Return M_u, the zones nearest to the robot, and the links (Alg. 2, l. 36-42; R7, R9, R15)."""
    pieces = strips(scan)
    zones = {}
    for label in sorted({piece.label for piece in pieces}):
        region = areal(unary_union([p.polygon for p in pieces if p.label == label]))
        if region.area > options.min_zone_area:
            zones[label] = region
    distances = {label: region.distance(Place(scan.position)) for label, region in zones.items()}
    least = min(distances.values(), default=0.0)
    nearest = {label for label, distance in distances.items() if distance <= least + SAME}
    if options.edges is Edges.SEEN:
        here = min(nearest, default="")
        return SensorMap(zones, nearest, [((here, s), zones[s]) for s in zones if s != here])
    return SensorMap(zones, nearest, _entries(pieces, zones))


def _entries(pieces: list[Strip], zones: dict[str, Region]) -> list[tuple[Crossing, Region]]:
    """Return each pair that a strip crosses (R15), with the ground that is entered."""
    entries = []
    for pair in sorted({(p.source, p.label) for p in pieces}, key=lambda p: (p[1], p[0])):
        if pair[0] != pair[1] and pair[0] in zones and pair[1] in zones:
            entered = [p.polygon for p in pieces if (p.source, p.label) == pair]
            entries.append((pair, areal(unary_union(entered))))
    return entries


def crossings(scan: Scan) -> set[Crossing]:
    """Return every pair of labels that a single beam crosses (R15)."""
    found = {(piece.source, piece.label) for beam in scan.beams for piece in beam}
    return {pair for pair in found if pair[0] and pair[0] != pair[1]}


def update(state: State, seen: SensorMap, position: Point) -> Step:
    """Take a sensor map into the state (Alg. 3)."""
    if not seen.zones:  # R8
        return Step(state, None, [])
    here = min(seen.nearest)  # l. 1-2, R7
    zones, nodes, edges = dict(state.zones), list(state.nodes), dict(state.edges)
    events: list[str | Crossing] = []
    done = []
    for label in [here, *(other for other in sorted(seen.zones) if other != here)]:
        done.append(label)
        region = seen.zones[label]
        if label in nodes:  # l. 4-7, 15-18
            zones[label] = areal(unary_union([zones[label], region]))  # R12
        else:  # l. 9-10, 24-26
            zones[label] = region
            nodes.append(label)
            events.append(label)
        for pair, entered in seen.entries:
            complete = label in pair and pair[0] in done and pair[1] in done
            if complete and pair not in edges:  # l. 19-21, 27, R10
                edges[pair] = nearest(entered, position)
                events.append(pair)
    return Step(State(zones, nodes, edges), here, events)


def nearest(region: Region, position: Point) -> Edge:
    """GetNearestPoint (R11)."""
    place = Place(position)
    point = nearest_points(region, place)[0]
    return Edge((point.x, point.y), point.distance(place))


def run(scans: Iterable[Scan], options: MappingOptions) -> list[Step]:
    """Run Algorithm 1 on scans."""
    state = State()
    steps = []
    for scan in scans:
        taken = update(state, extract(scan, options), scan.position)
        steps.append(taken)
        state = taken.state
    return steps


def areal(geometry: BaseGeometry) -> Region:
    """Return the polygons of a geometry, and no line or point."""
    if isinstance(geometry, Polygon | MultiPolygon):
        return geometry
    parts = getattr(geometry, "geoms", [])
    return MultiPolygon([part for part in parts if isinstance(part, Polygon)])
