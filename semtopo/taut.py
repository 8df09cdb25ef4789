"""The shortest polyline between two points of a triangulated region, exactly.

A *view* is what one sees from a vertex of the path, the root, through one side of a triangle. Views
are followed from triangle to triangle, the most promising first (Polyanya: Cui, Harabor and
Grastien, "Compromise-free pathfinding on a navigation mesh", IJCAI 2017); where a view ends at a
corner, the path may bend there. Unlike a funnel in a corridor of triangles, this is optimal also
among holes.

A view is bounded by the two vertices (or the straight continuation of the path) that limit it, not
by computed points on sides: so no rounding piles up from triangle to triangle.
"""

from __future__ import annotations

import math
from heapq import heappop, heappush
from typing import TypeAlias

from semtopo.triangulation import WALL, Triangulation
from semtopo.types import Point

NO_VERTEX = -1

Bound: TypeAlias = tuple[float, float, int]
"""A point on the edge of a view, and its vertex if it is one."""

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
        self.mesh, self.start, self.goal = mesh, start, goal
        self.root = len(mesh.xs)
        self.xs, self.ys = mesh.xs, mesh.ys
        self.lengths: dict[int, float] = {self.root: 0.0}
        self.parents: dict[int, int] = {}
        self.turned: dict[tuple[int, bool], float] = {}
        self.views: list[View] = []
        self.best, self.last = math.inf, NO_VERTEX
        self.ends = set(mesh.locate(goal))

    def run(self) -> None:
        """Follow views until none can lead to a shorter path."""
        starts = self.mesh.locate(self.start)
        parts = self.mesh.parts
        if not {parts[one] for one in starts} & {parts[one] for one in self.ends}:
            return
        self.begin(starts)
        while self.views:
            bound, length, root, edge, left, right = heappop(self.views)
            if bound >= self.best:
                return
            if length <= self.lengths[root]:
                self.follow(length, root, edge, left, right)

    def polyline(self) -> list[Point] | None:
        """Return the best path found, from start to goal."""
        if self.last == NO_VERTEX:
            return None
        points, vertex = [self.goal], self.last
        while vertex != self.root:
            points.append((self.xs[vertex], self.ys[vertex]))
            vertex = self.parents[vertex]
        points.append(self.start)
        bends = [one for one, other in zip(points[1:], points, strict=False) if one != other]
        return [*reversed(bends), self.goal] if bends else [self.start, self.goal]

    def place(self, vertex: int) -> Point:
        """Return where a vertex, or the start, is."""
        return self.start if vertex == self.root else (self.xs[vertex], self.ys[vertex])

    def begin(self, starts: list[int]) -> None:
        """Look out of every triangle that the start lies in."""
        mesh = self.mesh
        for triangle in starts:
            if triangle in self.ends:
                self.arrive(0.0, self.root, self.start)
            for edge in range(3 * triangle, 3 * triangle + 3):
                right, left = mesh.origins[edge], mesh.origins[mesh.following[edge]]
                if _side(self.start, self.place(right), *self.place(left)) > 0:
                    self.look(0.0, self.root, mesh.twins[edge], self.bound(left), self.bound(right))

    def bound(self, vertex: int) -> Bound:
        """Return a vertex as the bound of a view."""
        return (self.xs[vertex], self.ys[vertex], vertex)

    def arrive(self, length: float, root: int, place: Point) -> None:
        """Note a path to the goal whose last bend is the root."""
        total = length + math.dist(place, self.goal)
        if total < self.best:
            self.best, self.last = total, root

    def look(self, length: float, root: int, edge: int, left: Bound, right: Bound) -> None:
        """Open a view through a half-edge, unless it is a wall or cannot lead to a better path."""
        if edge == WALL:
            return
        place = self.place(root)
        if edge // 3 in self.ends and (
            _side(place, left, *self.goal) <= 0 <= _side(place, right, *self.goal)
        ):
            self.arrive(length, root, place)
        least = length + self.remaining(place, edge, left, right)
        if least < self.best:
            heappush(self.views, (least, length, root, edge, left, right))

    def remaining(self, place: Point, edge: int, left: Bound, right: Bound) -> float:
        """Return the least length from a root through a view to the goal, walls beyond ignored."""
        one = self.mesh.origins[edge]
        other = self.mesh.origins[self.mesh.following[edge]]
        base, tip = self.place(one), self.place(other)
        goal = self.goal
        if _side(base, tip, *goal) < 0:
            goal = _mirrored(goal, base, tip)
        if _side(place, left, *goal) > 0:
            via = base if left[2] == one else _crossing(place, left, base, tip)
        elif _side(place, right, *goal) < 0:
            via = tip if right[2] == other else _crossing(place, right, base, tip)
        else:
            return math.dist(place, goal)
        return math.dist(place, via) + math.dist(via, goal)

    def follow(self, length: float, root: int, edge: int, left: Bound, right: Bound) -> None:
        """Look on through the two other sides of a triangle, and round the corners of the view."""
        mesh, place = self.mesh, self.place(root)
        onward, back = mesh.following[edge], mesh.preceding[edge]
        apex = self.bound(mesh.origins[back])
        if left[2] == mesh.origins[edge]:
            self.turn(length, root, edge, leftward=True)
        if right[2] == mesh.origins[onward]:
            self.turn(length, root, onward, leftward=False)
        beyond_left = _side(place, left, apex[0], apex[1]) > 0
        beyond_right = _side(place, right, apex[0], apex[1]) < 0
        if not beyond_right:
            self.look(length, root, mesh.twins[onward], left if beyond_left else apex, right)
        if not beyond_left:
            self.look(length, root, mesh.twins[back], left, right if beyond_right else apex)

    def turn(self, length: float, root: int, spoke: int, *, leftward: bool) -> None:
        """Bend the path at a corner, the origin of a spoke, if this is the best way to it."""
        corner, place = self.mesh.origins[spoke], self.place(root)
        if not self.mesh.corners[corner]:
            return
        here = self.place(corner)
        total = length + math.dist(place, here)
        if (
            total > self.lengths.get(corner, math.inf)
            or total >= self.turned.get((corner, leftward), math.inf)
            or total + math.dist(here, self.goal) >= self.best
        ):
            return
        self.lengths[corner], self.parents[corner] = total, root
        self.turned[corner, leftward] = total
        ahead = (2 * here[0] - place[0], 2 * here[1] - place[1], NO_VERTEX)
        (self.fan_left if leftward else self.fan_right)(total, corner, spoke, ahead)

    def fan_left(self, length: float, corner: int, first: int, ahead: Bound) -> None:
        """Look from a corner through the triangles round it, counter-clockwise up to the wall."""
        mesh, here, spoke = self.mesh, self.place(corner), first
        while True:
            if spoke // 3 in self.ends:
                self.arrive(length, corner, here)
            near = self.bound(mesh.origins[mesh.following[spoke]])
            far = self.bound(mesh.origins[mesh.preceding[spoke]])
            if _side(here, ahead, far[0], far[1]) > 0:
                right = near if _side(here, ahead, near[0], near[1]) > 0 else ahead
                self.look(length, corner, mesh.twins[mesh.following[spoke]], far, right)
            spoke = mesh.twins[mesh.preceding[spoke]]
            if spoke in {WALL, first}:
                return

    def fan_right(self, length: float, corner: int, first: int, ahead: Bound) -> None:
        """Look from a corner through the triangles round it, clockwise up to the wall."""
        mesh, here, spoke = self.mesh, self.place(corner), first
        while True:
            if spoke // 3 in self.ends:
                self.arrive(length, corner, here)
            far = self.bound(mesh.origins[mesh.following[spoke]])
            near = self.bound(mesh.origins[mesh.preceding[spoke]])
            if _side(here, ahead, far[0], far[1]) < 0:
                left = near if _side(here, ahead, near[0], near[1]) < 0 else ahead
                self.look(length, corner, mesh.twins[mesh.following[spoke]], left, far)
            other = mesh.twins[spoke]
            if other == WALL or mesh.following[other] == first:
                return
            spoke = mesh.following[other]


def _side(base: Point, tip: Bound | Point, x: float, y: float) -> float:
    """Return twice the area of base, tip, (x, y): positive if it lies left of the ray."""
    return (tip[0] - base[0]) * (y - base[1]) - (tip[1] - base[1]) * (x - base[0])


def _mirrored(point: Point, base: Point, tip: Point) -> Point:
    """Return a point mirrored at a line."""
    dx, dy = tip[0] - base[0], tip[1] - base[1]
    scale = 2 * _side(base, tip, *point) / (dx * dx + dy * dy)
    return (point[0] + scale * dy, point[1] - scale * dx)


def _crossing(root: Point, bound: Bound, base: Point, tip: Point) -> Point:
    """Return where the ray from a root through a bound meets a side, kept within that side."""
    one, other = _side(root, bound, *base), _side(root, bound, *tip)
    share = min(max(one / (one - other), 0.0), 1.0) if one != other else 0.0
    return (base[0] + share * (tip[0] - base[0]), base[1] + share * (tip[1] - base[1]))
