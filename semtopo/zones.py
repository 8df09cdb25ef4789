"""The sensor map M_u: polygonal zones seen in one scan (Alg. 2, l. 36-42; R6).

In comes a scan; out go its zones, and which of them the beams linked. This room remembers nothing:
what was known before is the business of `metric` and `graph`.

A zone is the union of strips. A strip lies between two neighbouring beams, and joins an interval of
the one to an interval of the other: same label, both from the robot or both not, overlapping in
radius.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import shapely

from semtopo.doorways import SeenDoorways, seen_doorways
from semtopo.geometry import (
    NO_AREA,
    Polygons,
    Region,
    coverage_union,
    nearest_point,
    union,
    vertex_flags,
)
from semtopo.scan import Scan
from semtopo.types import Bytes, Edges, Floats, Integers, MappingOptions, Occupancy, Point

SAME_DISTANCE = 1e-9
"""m; far above what rounding does to a distance indoors, far below what a sensor can tell."""


@dataclass(frozen=True, slots=True, eq=False)
class Border:
    """Characteristic points on the border of a region: `xy` (n, 2) in m, `occupancy` (n,)."""

    xy: Floats
    occupancy: Bytes

    def joined(self, other: Border) -> Border:
        """Return the points of both; of two claims on one place the greater occupancy holds."""
        xy = np.concatenate([self.xy, other.xy])
        occupancy = np.concatenate([self.occupancy, other.occupancy])
        order = np.lexsort((-occupancy.astype(np.int8), xy[:, 1], xy[:, 0]))
        xy, occupancy = xy[order], occupancy[order]
        first = np.ones(len(xy), dtype=np.bool_)
        first[1:] = (xy[1:] != xy[:-1]).any(axis=1)
        return Border(xy[first], occupancy[first])

    def on(self, region: Region) -> Border:
        """Return the points that are vertices of a region."""
        kept = vertex_flags(self.xy, region)
        return Border(self.xy[kept], self.occupancy[kept])


@dataclass(frozen=True, slots=True, eq=False)
class Zone:
    """A zone of one scan z_u: its label, its region in m, map frame, and its border points."""

    label: str
    region: Region
    border: Border


@dataclass(frozen=True, slots=True, eq=False)
class Link:
    """Evidence in one scan that one passes from `source` to `target`.

    `strips` are polygons: the part of the target that one enters.
    """

    source: str
    target: str
    strips: Polygons

    def nearest_point(self, position: Point) -> Point:
        """Return the point of the entered part that is nearest to the robot (R11)."""
        return nearest_point(union(self.strips), position)


@dataclass(frozen=True, slots=True, eq=False)
class SensorMap:
    """The zones of one scan M_u, sorted by label, with the position p_r it was taken from.

    `here` is the label s_r of the nearest zone, `None` if the scan shows no zone (R8). `links` are
    the edges that the scan speaks for, by the option `edges` (R15), `doorways` the ground that it
    shows between zones.
    """

    position: Point
    zones: tuple[Zone, ...]
    here: str | None
    links: tuple[Link, ...]
    doorways: tuple[SeenDoorways, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class Strips:
    """Pairs of intervals on neighbouring beams, (strips,) each: the beam before, the beam after."""

    left: Integers
    right: Integers
    shapes: Polygons
    """Their polygons; none is without area."""


def extract(scan: Scan, options: MappingOptions) -> SensorMap:
    """Build the zones of a scan and find the one where the robot is (Alg. 2, l. 36-42).

    Zones not above `min_zone_area` are left out (R9); so is all that has no area.
    """
    strips = find_strips(scan)
    zones = tuple(_zones(scan, strips, options.min_zone_area))
    here = _nearest(zones, scan.position)
    if here is None:
        return SensorMap(scan.position, (), None, ())
    known = {zone.label for zone in zones}
    if options.edges is Edges.ADJACENT:
        links = tuple(_adjacent_links(scan, strips, known))
    else:
        links = tuple(_seen_links(here, scan, strips, zones))
    doorways = seen_doorways(scan, strips.left, strips.right, strips.shapes)
    between = tuple(seen for seen in doorways if {seen.source, seen.target} <= known)
    return SensorMap(scan.position, zones, here, links, between)


def find_strips(scan: Scan) -> Strips:
    """Return every strip of a scan that has area (R6)."""
    left, right = _overlapping(scan)
    spans = scan.intervals
    matching = (spans.label[left] == spans.label[right]) & (
        (spans.near[left] == 0) == (spans.near[right] == 0)
    )
    left, right = left[matching], right[matching]
    corners = np.stack(
        [
            scan.near_points(left),
            scan.far_points(left),
            scan.far_points(right),
            scan.near_points(right),
        ],
        axis=1,
    )
    shapes = np.asarray(shapely.polygons(corners), dtype=np.object_)
    solid = shapely.area(shapes) > NO_AREA
    return Strips(left[solid], right[solid], shapes[solid])


def _overlapping(scan: Scan) -> tuple[Integers, Integers]:
    """Return every pair of intervals on neighbouring beams that overlap in radius.

    The intervals of a beam are in order and lie apart, so the partners of each stand in a row; they
    are found without a look at the others, of which a scan may have very many.
    """
    spans, beams = scan.intervals, len(scan.directions)
    radii, rank = np.unique(np.concatenate([spans.near, spans.far]), return_inverse=True)
    near, far = rank[: len(spans)], rank[len(spans) :]
    here, there = spans.beam * len(radii), (spans.beam + 1) % beams * len(radii)
    first = np.searchsorted(here + far, there + near, side="left")
    end = np.searchsorted(here + near, there + far, side="right")
    partners = end - first
    if not scan.ring:
        partners[spans.beam == beams - 1] = 0
    left = np.repeat(np.arange(len(spans)), partners)
    offset = np.arange(len(left)) - np.repeat(np.cumsum(partners) - partners, partners)
    return left, np.repeat(first, partners) + offset


def _zones(scan: Scan, strips: Strips, min_zone_area: float) -> Iterator[Zone]:
    """Yield the zones in the order of their labels (Alg. 2, l. 36-42)."""
    spans = _places(scan.intervals.label)
    chosen = _places(scan.intervals.label[strips.left])
    for number in sorted(chosen, key=scan.labels.__getitem__):
        region = _joined(strips, chosen[number])
        if region.area > min_zone_area:
            yield Zone(scan.labels[number], region, _border(scan, spans[number]).on(region))


def _places(numbers: Integers) -> dict[int, Integers]:
    """Return where each number stands in an array, ascending."""
    order = np.argsort(numbers, kind="stable")
    found, first = np.unique(numbers[order], return_index=True)
    parts = np.split(order, first[1:])  # one part, also of nothing
    return dict(zip(found.tolist(), parts, strict=False))


def _joined(strips: Strips, chosen: Integers) -> Region:
    """Return the union of the chosen strips.

    Strips that share an interval share a whole side, and no two overlap; so the fast union for
    coverages serves. It does not where an interval has two partners on one side, nor where a real
    sensor's last beam looks along its first, which shows in the result.
    """
    left, right = strips.left[chosen], strips.right[chosen]
    if len(np.unique(left)) == len(left) and len(np.unique(right)) == len(right):
        region = coverage_union(strips.shapes[chosen])
        if region.is_valid:
            return region
    return union(strips.shapes[chosen])


def _border(scan: Scan, mine: Integers) -> Border:
    """Return all characteristic points of the intervals of a label (Alg. 2, l. 38-39)."""
    spans = scan.intervals
    xy = np.concatenate([scan.near_points(mine), scan.far_points(mine)])
    occupancy = np.concatenate([spans.near_occupancy[mine], spans.far_occupancy[mine]])
    kept = occupancy != Occupancy.NONE
    return Border(xy[kept], occupancy[kept])


def _nearest(zones: tuple[Zone, ...], position: Point) -> str | None:
    """Return the label of the zone nearest to the robot (Alg. 3, l. 1-2; ties by label, R7).

    Samples stand at equal distances, so ties are common; rounding must not decide them.
    """
    place = shapely.Point(position)
    distances = [zone.region.distance(place) for zone in zones]
    near = min(distances, default=0.0) + SAME_DISTANCE
    labels = [zone.label for zone, far in zip(zones, distances, strict=True) if far <= near]
    return min(labels, default=None)


def _seen_links(here: str, scan: Scan, strips: Strips, zones: tuple[Zone, ...]) -> Iterator[Link]:
    """Yield a link from here to every other zone (Alg. 3, l. 13-29)."""
    places = _places(scan.intervals.label[strips.left])
    named = {scan.labels[number]: found for number, found in places.items()}
    for zone in zones:
        if zone.label != here:
            yield Link(here, zone.label, strips.shapes[named[zone.label]])


def _adjacent_links(scan: Scan, strips: Strips, known: set[str]) -> Iterator[Link]:
    """Yield a link for every pair of zones with strips that lead from one to the other (R15).

    Both beams of a strip must come through: one alone may have slipped through a wall. The strips
    that lead there are what one enters, and not all that is seen of the target.
    """
    spans = scan.intervals
    source, target = spans.source[strips.left], spans.label[strips.left]
    (entered,) = np.nonzero(
        (source >= 0) & (source != target) & (source == spans.source[strips.right])
    )
    count = len(scan.labels)
    leading = {
        (scan.labels[pair // count], scan.labels[pair % count]): strips.shapes[entered[found]]
        for pair, found in _places(source[entered] * count + target[entered]).items()
    }
    for one, other in sorted(leading, key=lambda pair: (pair[1], pair[0])):
        if {one, other} <= known:
            yield Link(one, other, leading[one, other])
