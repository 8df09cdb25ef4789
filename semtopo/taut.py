"""The shortest polyline between two points of a triangulated region, exactly.

A *view* is what one sees from a vertex of the path, the root, through one side of a triangle. Views
are followed from triangle to triangle, the most promising first (Polyanya: Cui, Harabor and
Grastien, "Compromise-free pathfinding on a navigation mesh", IJCAI 2017); where a view ends at a
corner, the path may bend there. Unlike a funnel in a corridor of triangles, this is optimal also
among holes.

A view is bounded by the directions to the two vertices (or the straight continuation of the path)
that limit it, not by computed points on sides: so no rounding piles up from triangle to triangle.
"""

from __future__ import annotations

import math
from heapq import heappop, heappush
from typing import TypeAlias

from semtopo.triangulation import WALL, Triangulation
from semtopo.types import Point

NO_VERTEX = -1

ROUNDING = 1e-14
"""How far off two ways to compute on which side of a line a point is may be, for lengths of 1 m."""

Bound: TypeAlias = tuple[float, float, int]
"""A direction from the root along the edge of a view, in m, and its vertex if it leads to one."""

View: TypeAlias = tuple[float, float, int, int, Bound, Bound]
"""Least length of a path through it, length up to its root, root, half-edge that is entered (with
the triangle beyond on its left), left bound, right bound."""


def shortest_polyline(mesh: Triangulation, start: Point, goal: Point) -> list[Point] | None:
    """Return the shortest polyline from start to goal, both of the region; None if there is none.

    From a point to itself it is that point twice. Of several shortest ones, always the same.
    """
    search = _Search(mesh, start, goal)
    search.run()
    return search.polyline()


class _Search:
    """One search: what is open, and the best way known to each vertex and to the goal."""

    def __init__(self, mesh: Triangulation, start: Point, goal: Point) -> None:
        self.mesh, self.goal = mesh, goal
        self.root = len(mesh.points)
        self.points = [*mesh.points, start]
        self.lengths: dict[int, float] = {self.root: 0.0}
        self.parents: dict[int, int] = {}
        self.turned: dict[tuple[int, bool], float] = {}
        self.views: list[View] = []
        self.best, self.last = math.inf, NO_VERTEX
        self.starts, self.ends = mesh.locate(start), set(mesh.locate(goal))
        self.passed = self.ways_out([*self.starts, *self.ends])

    def run(self) -> None:
        """Follow views until none can lead to a shorter path."""
        self.begin()
        while self.views:
            least, length, root, edge, left, right = heappop(self.views)
            if least >= self.best:
                return
            if length <= self.lengths[root]:
                self.follow(length, root, edge, left, right)

    def polyline(self) -> list[Point] | None:
        """Return the best path found, from start to goal."""
        if self.last == NO_VERTEX:
            return None
        points, vertex = [self.goal], self.last
        while vertex != self.root:
            points.append(self.points[vertex])
            vertex = self.parents[vertex]
        start = self.points[self.root]
        points.append(start)
        bends = [one for one, other in zip(points[1:], points, strict=False) if one != other]
        return [*reversed(bends), self.goal] if bends else [start, self.goal]

    def ways_out(self, triangles: list[int]) -> set[int]:
        """Return the triangles by which one gets from some out of dead ends; others are no way."""
        mesh, found = self.mesh, set[int]()
        for triangle in triangles:
            here = triangle
            while here not in found:
                found.add(here)
                exit_ = mesh.exits[here]
                if exit_ == WALL:
                    break
                here = mesh.twins[exit_] // 3
        return found

    def begin(self) -> None:
        """Look out of every triangle that the start lies in."""
        mesh, root = self.mesh, self.root
        for triangle in self.starts:
            if triangle in self.ends:
                self.arrive(0.0, root)
            for edge in range(3 * triangle, 3 * triangle + 3):
                right = self.bound(root, mesh.origins[edge])
                left = self.bound(root, mesh.origins[mesh.following[edge]])
                if _side(right, left[0], left[1]) > 0:
                    self.look(0.0, root, mesh.twins[edge], left, right)

    def bound(self, root: int, vertex: int) -> Bound:
        """Return the direction from a root to a vertex as the bound of a view."""
        (x, y), (to_x, to_y) = self.points[root], self.points[vertex]
        return (to_x - x, to_y - y, vertex)

    def arrive(self, length: float, root: int) -> None:
        """Note a path to the goal whose last bend is the root."""
        total = length + math.dist(self.points[root], self.goal)
        if total < self.best:
            self.best, self.last = total, root

    def look(self, length: float, root: int, edge: int, left: Bound, right: Bound) -> None:
        """Open a view through a half-edge, unless it is a wall or cannot lead to a better path."""
        if edge == WALL or (self.mesh.exits[edge // 3] != WALL and edge // 3 not in self.passed):
            return
        x, y = self.points[root]
        dx, dy = self.goal[0] - x, self.goal[1] - y
        if edge // 3 in self.ends and (
            _side(left, dx, dy) <= _doubt(left, dx, dy)
            and _side(right, dx, dy) >= -_doubt(right, dx, dy)
        ):
            self.arrive(length, root)
        least = length + self.remaining(root, edge, left, right)
        if least < self.best:
            heappush(self.views, (least, length, root, edge, left, right))

    def remaining(self, root: int, edge: int, left: Bound, right: Bound) -> float:
        """Return the least length from a root through a view to the goal, walls beyond ignored."""
        mesh, place, goal = self.mesh, self.points[root], self.goal
        one, other = mesh.origins[edge], mesh.origins[mesh.following[edge]]
        base, tip = self.points[one], self.points[other]
        along = (tip[0] - base[0], tip[1] - base[1], NO_VERTEX)
        if _side(along, goal[0] - base[0], goal[1] - base[1]) < 0:
            goal = _mirrored(goal, base, along)
        dx, dy = goal[0] - place[0], goal[1] - place[1]
        if _side(left, dx, dy) > 0:
            via = base if left[2] == one else _crossing(place, left, base, tip)
        elif _side(right, dx, dy) < 0:
            via = tip if right[2] == other else _crossing(place, right, base, tip)
        else:
            return math.hypot(dx, dy)
        return math.dist(place, via) + math.dist(via, goal)

    def follow(self, length: float, root: int, edge: int, left: Bound, right: Bound) -> None:
        """Look on through the two other sides of a triangle, and round the corners of the view."""
        mesh = self.mesh
        onward, back = mesh.following[edge], mesh.preceding[edge]
        apex = self.bound(root, mesh.origins[back])
        if left[2] == mesh.origins[edge] and mesh.corners[left[2]]:
            self.turn(length, root, edge, leftward=True)
        if right[2] == mesh.origins[onward] and mesh.corners[right[2]]:
            self.turn(length, root, onward, leftward=False)
        beyond_left = _side(left, apex[0], apex[1]) > 0
        beyond_right = _side(right, apex[0], apex[1]) < 0
        if not beyond_right:
            self.look(length, root, mesh.twins[onward], left if beyond_left else apex, right)
        if not beyond_left:
            self.look(length, root, mesh.twins[back], left, right if beyond_right else apex)

    def turn(self, length: float, root: int, spoke: int, *, leftward: bool) -> None:
        """Bend the path at a corner, the origin of a spoke, if this is the best way to it."""
        corner = self.mesh.origins[spoke]
        here = self.points[corner]
        total = length + math.dist(self.points[root], here)
        if (
            total > self.lengths.get(corner, math.inf)
            or total >= self.turned.get((corner, leftward), math.inf)
            or total + math.dist(here, self.goal) >= self.best
        ):
            return
        self.lengths[corner], self.parents[corner] = total, root
        self.turned[corner, leftward] = total
        x, y, _ = self.bound(root, corner)
        (self.fan_left if leftward else self.fan_right)(total, corner, spoke, (x, y, NO_VERTEX))

    def fan_left(self, length: float, corner: int, first: int, ahead: Bound) -> None:
        """Look from a corner through the triangles round it, counter-clockwise up to the wall."""
        mesh, spoke = self.mesh, first
        while True:
            if spoke // 3 in self.ends:
                self.arrive(length, corner)
            outer = mesh.following[spoke]
            far = self.bound(corner, mesh.origins[mesh.preceding[spoke]])
            if _side(ahead, far[0], far[1]) >= -_doubt(ahead, far[0], far[1]):
                near = self.bound(corner, mesh.origins[outer])
                right = near if _side(ahead, near[0], near[1]) > 0 else ahead
                self.look(length, corner, mesh.twins[outer], far, right)
            spoke = mesh.twins[mesh.preceding[spoke]]
            if spoke in {WALL, first}:
                return

    def fan_right(self, length: float, corner: int, first: int, ahead: Bound) -> None:
        """Look from a corner through the triangles round it, clockwise up to the wall."""
        mesh, spoke = self.mesh, first
        while True:
            if spoke // 3 in self.ends:
                self.arrive(length, corner)
            outer = mesh.following[spoke]
            far = self.bound(corner, mesh.origins[outer])
            if _side(ahead, far[0], far[1]) <= _doubt(ahead, far[0], far[1]):
                near = self.bound(corner, mesh.origins[mesh.preceding[spoke]])
                left = near if _side(ahead, near[0], near[1]) < 0 else ahead
                self.look(length, corner, mesh.twins[outer], left, far)
            other = mesh.twins[spoke]
            if other == WALL or mesh.following[other] == first:
                return
            spoke = mesh.following[other]


def _side(bound: Bound, dx: float, dy: float) -> float:
    """Return a positive number if (dx, dy) points to the left of a bound, negative to the right."""
    return bound[0] * dy - bound[1] * dx


def _doubt(bound: Bound, dx: float, dy: float) -> float:
    """Return how large a side must be to be sure of it: what is straight ahead is on both sides."""
    length = abs(bound[0]) + abs(bound[1])
    return ROUNDING * length * (length + abs(dx) + abs(dy))


def _mirrored(point: Point, base: Point, along: Bound) -> Point:
    """Return a point mirrored at the line from a base along a direction."""
    dx, dy, _ = along
    scale = 2 * _side(along, point[0] - base[0], point[1] - base[1]) / (dx * dx + dy * dy)
    return (point[0] + scale * dy, point[1] - scale * dx)


def _crossing(root: Point, bound: Bound, base: Point, tip: Point) -> Point:
    """Return where the ray from a root along a bound meets a side, kept within that side."""
    one = _side(bound, base[0] - root[0], base[1] - root[1])
    other = _side(bound, tip[0] - root[0], tip[1] - root[1])
    share = min(max(one / (one - other), 0.0), 1.0) if one != other else 0.0
    return (base[0] + share * (tip[0] - base[0]), base[1] + share * (tip[1] - base[1]))
