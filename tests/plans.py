"""Small worlds drawn as ASCII art, and a floor of many rooms with the path that visits them all."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import groupby, pairwise
from math import ceil, hypot

from semtopo.types import Kind, Point
from semtopo.world import World, WorldZone

KINDS = {"#": Kind.OBSTACLE, "+": Kind.PASSAGE, "?": Kind.UNKNOWN}
"""A letter is the label of a space; a blank is nothing at all, which is an obstacle too."""

TWO_ROOMS = """
    #######
    #aa+bb#
    #aa+bb#
    #aa+bb#
    #######
"""
"""Two rooms with a door between them as wide as they are."""

TOUCHING = """
    ######
    #aabb#
    #aabb#
    ######
"""
"""Two spaces that touch without a passage (R5)."""

LOOP = """
    #########
    #ccccccc#
    #c#####c#
    #c#aaa#c#
    #c+aaa#c#
    #c#aaa#c#
    #c#####c#
    #ccccccc#
    #########
"""
"""A corridor around a room, with one door."""

THREE_IN_A_ROW = """
    ###########
    #aaa+bb+cc#
    #aaa+bb+cc#
    #aaa+bb+cc#
    ###########
"""
"""Three rooms; from `a` one sees `c` through `b` (R15)."""

TWO_DOORS = """
    #########
    #aaaaaaa#
    #+#####+#
    #bbbbbbb#
    #########
"""
"""Two rooms with two doors between them (R10)."""


def drawn(art: str, cell: float = 1.0) -> World:
    """Return the world of a drawing: cells of `cell` m, the lowest row on the x axis, blanks kept.

    Equal neighbours in a row are one rectangle; all rows are indented as the first one is.
    """
    rows = [row for row in art.splitlines() if row.strip()]
    indent = len(rows[0]) - len(rows[0].lstrip())
    zones: list[WorldZone] = []
    for height, row in enumerate(reversed(rows)):
        start = 0
        for sign, group in groupby(row[indent:].rstrip()):
            stop = start + len(list(group))
            low, high = (start * cell, height * cell), (stop * cell, (height + 1) * cell)
            if sign != " ":
                zones.append(WorldZone(sign, KINDS.get(sign, Kind.SPACE), low, high))
            start = stop
    return World(zones)


def stepped(corners: Iterable[Point], stride: float) -> list[Point]:
    """Return points at most `stride` m apart on the way through the corners, and these."""
    points: list[Point] = []
    for (x0, y0), (x1, y1) in pairwise(corners):
        count = max(1, ceil(hypot(x1 - x0, y1 - y0) / stride))
        parts = [step / count for step in range(count)]
        points += [(x0 + part * (x1 - x0), y0 + part * (y1 - y0)) for part in parts]
        last = (x1, y1)
    return [*points, last]


class Floor:
    """Two parallel corridors linked at both ends, with rooms on both sides of each.

    Corridors `south` and `north` run along x, links `west` and `east` along y; everything is
    separated by walls 0.25 m thick and joined by doors: 36 zones with 8 rooms in a row. A room is
    named after its row (1 to 4 from the south) and its place in it: `r1-1` ... `r4-8`.
    """

    ROOM = 3.0  # m, the width and depth of a room
    WALL = 0.25  # m
    HALL = 2.0  # m, the width of corridors and links
    DOOR = 1.0  # m

    def __init__(self, rooms_in_a_row: int = 8) -> None:
        """Lay the floor out."""
        self.columns = rooms_in_a_row
        self.pitch = self.ROOM + self.WALL
        self.length = self.columns * self.pitch - self.WALL
        depths = [self.ROOM, self.HALL, self.ROOM, self.ROOM, self.HALL, self.ROOM]
        self.heights = [sum(depths[:row]) + row * self.WALL for row in range(len(depths))]
        self.world = World([*self._rooms(), *self._halls()], name="floor")

    @property
    def rooms(self) -> dict[str, str]:
        """The corridor of each room."""
        halls = {1: "south", 2: "south", 3: "north", 4: "north"}
        numbers = range(1, self.columns + 1)
        return {f"r{row}-{n}": hall for row, hall in halls.items() for n in numbers}

    @property
    def doors(self) -> set[frozenset[str]]:
        """Every pair of zones that a door joins."""
        junctions = {frozenset((hall, link)) for hall in ("south", "north") for link in _LINKS}
        return junctions | {frozenset(pair) for pair in self.rooms.items()}

    def path(self, stride: float = 0.4) -> list[Point]:
        """Return a drive through both corridors and the links, into every room and back."""
        west, east = -self.WALL - self.HALL / 2, self.length + self.WALL + self.HALL / 2
        south, north = (self.heights[row] + self.HALL / 2 for row in (1, 4))
        corners = [(west, south), *self._visits(south, (0, 2)), (east, south), (east, north)]
        corners += [*reversed(list(self._visits(north, (3, 5)))), (west, north), (west, south)]
        return stepped(corners, stride)

    def _visits(self, hall: float, rows: tuple[int, int]) -> Iterator[Point]:
        """Yield the corners of a drive along a corridor, from the west, into all its rooms."""
        for column in range(self.columns):
            x = column * self.pitch + self.ROOM / 2
            for row in rows:
                yield from ((x, hall), (x, self.heights[row] + self.ROOM / 2), (x, hall))

    def _rooms(self) -> Iterator[WorldZone]:
        """Yield the rooms, each with its door."""
        for index, row in enumerate((0, 2, 3, 5)):
            y = self.heights[row]
            door = y + self.ROOM if row in (0, 3) else y - self.WALL
            for column in range(self.columns):
                x = column * self.pitch
                middle = x + self.ROOM / 2
                name = f"r{index + 1}-{column + 1}"
                yield WorldZone(name, Kind.SPACE, (x, y), (x + self.ROOM, y + self.ROOM))
                low, high = (
                    (middle - self.DOOR / 2, door),
                    (middle + self.DOOR / 2, door + self.WALL),
                )
                yield WorldZone("door", Kind.PASSAGE, low, high)

    def _halls(self) -> Iterator[WorldZone]:
        """Yield corridors and links, with the doors at their junctions."""
        ends = {"west": -self.WALL - self.HALL, "east": self.length + self.WALL}
        south, north = self.heights[1], self.heights[4]
        for name, y in (("south", south), ("north", north)):
            yield WorldZone(name, Kind.SPACE, (0, y), (self.length, y + self.HALL))
            for x in (-self.WALL, self.length):
                yield WorldZone("door", Kind.PASSAGE, (x, y), (x + self.WALL, y + self.HALL))
        for name, x in ends.items():
            yield WorldZone(name, Kind.SPACE, (x, south), (x + self.HALL, north + self.HALL))


_LINKS = ("west", "east")
