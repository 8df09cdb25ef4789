"""The world map M_w: labelled rectangles that can say what is where (section 2; Alg. 2, l. 6).

In come zones as rectangles; out goes, for any array of points, the label and kind found there. This
room knows nothing of sensors.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from semtopo.errors import InvalidWorldError
from semtopo.types import NOWHERE, Bytes, Floats, Integers, Kind, Point
from semtopo.window import SIDE, Offsets, Window

FEW_ZONES = 16
FEW_PAIRS = 2**16
"""Up to so many zones, or pairs of a point and a zone, each is looked at; above, it would take too
long."""


WINDOWS_MAX = 64
"""Windows kept at a time: 8 MiB at the very most, a hundredth of that indoors."""


@dataclass(frozen=True, slots=True)
class WorldZone:
    """A labelled rectangle z_w, closed, between the corners `low` and `high` in m, map frame.

    Raises
    ------
    InvalidWorldError
        A corner is not finite, `low` is not below `high` in both axes, or the label is empty.
    """

    label: str
    kind: Kind
    low: Point
    high: Point

    def __post_init__(self) -> None:
        """Refuse a rectangle without extent, and a zone without a name."""
        if not self.label:
            raise InvalidWorldError("a zone needs a label")
        if not all(map(math.isfinite, (*self.low, *self.high))):
            raise InvalidWorldError("corners must be finite")
        if not (self.low[0] < self.high[0] and self.low[1] < self.high[1]):
            raise InvalidWorldError("low must be below high in x and in y")


@dataclass(frozen=True, slots=True, eq=False)
class Surfaces:
    """What can be on top: pairs of `label` (index into `labels`) and `kind`, (surfaces,) each.

    The last surface is what lies outside all zones: `NOWHERE` and OBSTACLE.
    """

    labels: tuple[str, ...]
    label: Integers
    kind: Bytes


class World:
    """The world map M_w: rectangles in painter's order, the later one on top (R4).

    Raises
    ------
    InvalidWorldError
        There is no zone at all.
    """

    def __init__(self, zones: Sequence[WorldZone], *, name: str = "") -> None:
        """Index the rectangles."""
        if not zones:
            raise InvalidWorldError("a world needs at least one zone")
        self.name = name
        self.zones = tuple(zones)
        labels = tuple(dict.fromkeys(zone.label for zone in self.zones))
        numbers = {label: number for number, label in enumerate(labels)}
        pairs = dict.fromkeys((numbers[zone.label], zone.kind) for zone in self.zones)
        found = {pair: number for number, pair in enumerate(pairs)}
        self.surfaces = Surfaces(
            labels,
            np.array([*(label for label, _ in pairs), NOWHERE], dtype=np.intp),
            np.array([*(kind for _, kind in pairs), Kind.OBSTACLE], dtype=np.uint8),
        )
        # one entry more than there are zones: index -1 reads "no zone here"
        self._surface = np.array(
            [*(found[numbers[zone.label], zone.kind] for zone in self.zones), len(pairs)],
            dtype=np.intp,
        )
        self._low = np.array([zone.low for zone in self.zones], dtype=np.float64)
        self._high = np.array([zone.high for zone in self.zones], dtype=np.float64)
        boxes = np.asarray(shapely.box(*self._low.T, *self._high.T), dtype=np.object_)
        self._tree = shapely.STRtree(boxes)
        self._windows: dict[tuple[int, int, float], Window] = {}

    @property
    def labels(self) -> tuple[str, ...]:
        """What the label indices stand for."""
        return self.surfaces.labels

    def read(self, xy: Floats) -> tuple[Integers, Bytes]:
        """Return label index and kind at each point (ReadMap, R4).

        Points have the shape (..., 2), the answers the shape (...). On a common edge the later
        zone wins; outside all zones the label index is `NOWHERE` and the kind OBSTACLE.
        """
        surface = self._read(xy.reshape(-1, 2)).reshape(xy.shape[:-1])
        return self.surfaces.label[surface], self.surfaces.kind[surface]

    def read_around(self, centre: Point, offsets: Offsets) -> Integers:
        """Return the surface at each of the places (n,) around a centre (ReadMap, R4).

        What lies around is laid out once, and then serves from every centre near by; so the cost
        does not grow with the world.
        """
        window = self.window(centre, offsets.reach)
        if window is None:
            x, y = centre[0] + offsets.x, centre[1] + offsets.y
            return self._read(np.stack([x, y], axis=-1))
        return window.read(centre, offsets)

    def edges_around(self, centre: Point, reach: float) -> tuple[Floats, Floats]:
        """Return the x and the y of all edges that lie in reach of a centre, each once."""
        window = self.window(centre, reach)
        if window is not None:
            lines = window.x.edges, window.y.edges
        else:
            square = np.array([np.subtract(centre, reach), np.add(centre, reach)])
            numbers = self._zones_near(square)
            corners = np.concatenate([self._low[numbers], self._high[numbers]])
            lines = np.unique(corners[:, 0]), np.unique(corners[:, 1])
        x, y = lines
        return x[np.abs(x - centre[0]) <= reach], y[np.abs(y - centre[1]) <= reach]

    def window(self, centre: Point, reach: float) -> Window | None:
        """Return the window in whose middle third a centre lies; `None` if it would be too large.

        Windows are kept, up to a number; threads that want the same one at the same time may each
        lay it out.
        """
        key = (math.floor(centre[0] / reach), math.floor(centre[1] / reach), reach)
        window = self._windows.get(key)
        if window is None:
            window = self._laid(((key[0] - 1) * reach, (key[1] - 1) * reach), reach)
            if window is not None:
                self._windows = dict([*self._windows.items(), (key, window)][-WINDOWS_MAX:])
        return window

    def _laid(self, corner: Point, reach: float) -> Window | None:
        """Lay out the window that begins at a corner."""
        numbers = self._zones_near(np.array([corner, np.add(corner, SIDE * reach)]))
        surface = self._surface[np.append(numbers, -1)]
        return Window.laid(self._low[numbers], self._high[numbers], surface, corner, reach)

    def _read(self, points: Floats) -> Integers:
        """Return the surface at each of the points (n, 2)."""
        return self._surface[self._topmost(points, self._zones_near(points))]

    def _zones_near(self, points: Floats) -> Integers:
        """Return the numbers of the zones whose rectangle meets that of the points, ascending."""
        if len(points) == 0:
            return np.empty(0, dtype=np.intp)
        window = shapely.box(*points.min(axis=0), *points.max(axis=0))
        return np.sort(self._tree.query(window))

    def _topmost(self, points: Floats, numbers: Integers) -> Integers:
        """Return the last of some zones, ascending, that has each point (n, 2); -1 for none.

        Many points among many zones are halved until few of either are left: most zones miss the
        rectangle of few points, or cover it and hide what lies below. So the work stays small also
        where thousands of zones lie on one another.
        """
        if len(numbers) <= FEW_ZONES:
            return self._topmost_of_few(points, numbers)
        if len(points) * len(numbers) <= FEW_PAIRS:
            return self._topmost_at_once(points, numbers)
        low, high = points.min(axis=0), points.max(axis=0)
        lows, highs = self._low[numbers], self._high[numbers]
        shown = ((lows <= high) & (highs >= low)).all(axis=1)
        covering = np.flatnonzero(((lows <= low) & (highs >= high)).all(axis=1))
        shown[: covering[-1] if len(covering) else 0] = False
        half = len(points) // 2
        order = np.argpartition(points[:, np.argmax(high - low)], half)
        top = np.empty(len(points), dtype=np.intp)
        for part in (order[:half], order[half:]):
            top[part] = self._topmost(points[part], numbers[shown])
        return top

    def _topmost_of_few(self, points: Floats, numbers: Integers) -> Integers:
        """Do as `_topmost`, zone by zone."""
        x, y = points[:, 0], points[:, 1]
        top = np.full(len(points), -1, dtype=np.intp)
        for number in numbers:
            low, high = self._low[number], self._high[number]
            top[(x >= low[0]) & (x <= high[0]) & (y >= low[1]) & (y <= high[1])] = number
        return top

    def _topmost_at_once(self, points: Floats, numbers: Integers) -> Integers:
        """Do as `_topmost`, with every point and every zone side by side."""
        falling = np.append(numbers[::-1], -1)
        x, y = points[:, :1], points[:, 1:]
        (left, below), (right, above) = self._low[falling].T, self._high[falling].T
        inside = (x >= left) & (x <= right) & (y >= below) & (y <= above)
        inside[:, -1] = True  # -1 where there is no zone
        top: Integers = falling[inside.argmax(axis=1)]
        return top
