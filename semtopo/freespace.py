"""Dense paths through free space, for a round robot: as short as can be, and proved.

In comes a region where the robot may be seen from above, and its radius; out come paths. A path is
the shortest polyline within the region inset by the radius, and is checked against the region as
given before it is handed out: it lies in the region, and keeps its distance from the border.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property

import shapely
from shapely import LineString, STRtree

from semtopo.bottleneck import Bottleneck, find_bottleneck
from semtopo.errors.ways import NotConnectedError, OutsideError, TooNarrowError, UnprovedPathError
from semtopo.geometry import Region, nearest_point, widest_place
from semtopo.inset import inset, sides
from semtopo.taut import shortest_polyline
from semtopo.triangulation import TOUCHING, Triangulation, triangulate
from semtopo.types import Point

SNAP = 1e-4
"""m; how far from where it was asked to a path may begin and end: no robot knows its place so
well."""


NECKS_KEPT = 256
"""Pairs of places in memory of which it is known where the way between them is too narrow."""


@dataclass(frozen=True, slots=True)
class Path:
    """A polyline from start to goal: points, length and least distance to the border, in m."""

    points: tuple[Point, ...]
    length: float
    clearance: float


@dataclass(frozen=True, eq=False)
class FreeSpace:
    """Where a robot of some radius (m) may be within a region; built once, asked often.

    Parts of the region that meet in a point are not connected there. Each thing that a query needs
    is computed when it is first needed, and kept.
    """

    region: Region
    radius: float = 0.0
    _meshes: dict[int, Triangulation] = field(default_factory=dict)
    _necks: dict[tuple[Point, Point], Bottleneck | None] = field(default_factory=dict)

    @cached_property
    def inset(self) -> Region:
        """Return where the centre of the robot may be; it may be empty."""
        space = inset(self.region, self.radius)
        shapely.prepare(space)
        return space

    def path(self, start: Point, goal: Point) -> Path:
        """Return the shortest path from start to goal, proved to keep to free space.

        It begins and ends within SNAP of them. From a place to itself it is that place twice.

        Raises
        ------
        OutsideError
            If start or goal is not in free space.
        TooNarrowError
            If they are connected, but not for a robot of this radius.
        NotConnectedError
            If they are not connected at all.
        UnprovedPathError
            If the path found does not pass its check.
        """
        found = self.find(start, goal)
        if found is None:
            raise self._refusal(self._entered(start, "start"), self._entered(goal, "goal"))
        return found

    def find(self, start: Point, goal: Point) -> Path | None:
        """Return the same as `path`, but `None` where there is none; why not is costly to tell.

        Raises
        ------
        OutsideError
            If start or goal is not in free space.
        UnprovedPathError
            If the path found does not pass its check.
        """
        begin, end = self._entered(start, "start"), self._entered(goal, "goal")
        ways = (
            shortest_polyline(self._mesh(part), begin, end)
            for part in sorted(self._parts_at(begin) & self._parts_at(end))
        )
        paths = [self._proved(points) for points in ways if points is not None]
        return min(paths, key=lambda path: path.length, default=None)

    def distance(self, start: Point, goal: Point) -> float:
        """Return the length in m of the shortest path from start to goal; raises as `path` does."""
        return self.path(start, goal).length

    def nearest_place(self, point: Point) -> Point | None:
        """Return the place nearest to a point where the robot may be; None if it fits nowhere.

        The point itself if the robot may be there.
        """
        return None if self.inset.is_empty else nearest_point(self.inset, point)

    def clearance(self, point: Point) -> float:
        """Return the distance in m from a point, inside or not, to the border of the region."""
        _, distance = self._walls.query_nearest(
            shapely.Point(point), return_distance=True, all_matches=False
        )
        return float(distance[0])

    @cached_property
    def _parts(self) -> STRtree:
        return STRtree(shapely.get_parts(self.inset))

    def _parts_at(self, place: Point) -> set[int]:
        """Return the parts of the inset, by number, that a place of it lies in."""
        found = self._parts.query(shapely.Point(place), predicate="dwithin", distance=TOUCHING)
        return set(found.tolist())

    def _mesh(self, part: int) -> Triangulation:
        if part not in self._meshes:
            self._meshes[part] = triangulate(self._parts.geometries[part])
        return self._meshes[part]

    @cached_property
    def _walls(self) -> STRtree:
        shapely.prepare(self.region)
        return STRtree(sides(self.region))

    def _entered(self, point: Point, end: str) -> Point:
        """Return the place where a path begins or ends."""
        place = self.nearest_place(point)
        if place is not None and math.dist(place, point) <= SNAP:
            return place
        if not self.region.intersects(shapely.Point(point)):
            raise OutsideError(end, place, "is not in free space")
        if place is None and self.radius > 0:
            raise self._fits_nowhere()
        near = self.clearance(point)
        raise OutsideError(
            end, place, f"is {near:.3f} m from a wall, and the robot needs {self.radius:.3f} m"
        )

    def _fits_nowhere(self) -> TooNarrowError:
        point = widest_place(self.region)
        return TooNarrowError(point, 2 * self.clearance(point), 2 * self.radius)

    def _refusal(self, start: Point, goal: Point) -> NotConnectedError | TooNarrowError:
        """Return why there is no path between two places of the inset."""
        if (start, goal) not in self._necks:
            if len(self._necks) == NECKS_KEPT:
                self._necks.clear()
            self._necks[start, goal] = find_bottleneck(self.region, start, goal, self.radius)
        found = self._necks[start, goal]
        if found is None:
            return NotConnectedError("Start and goal lie in parts of free space that do not meet.")
        return TooNarrowError(found.point, found.width, 2 * self.radius)

    def _proved(self, points: list[Point]) -> Path:
        """Return a polyline as a path if it lies in the region and keeps its distance."""
        line = LineString(points)
        _, distances = self._walls.query_nearest(line, return_distance=True, all_matches=False)
        clearance = float(distances[0])
        if clearance < self.radius or not self.region.covers(line):
            raise UnprovedPathError(f"a path of {len(points)} points leaves free space")
        return Path(tuple(points), line.length, clearance)
