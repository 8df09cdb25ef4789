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
            raise InvalidWorldError(f"zone {self.label!r}: corners must be finite")
        if not (self.low[0] < self.high[0] and self.low[1] < self.high[1]):
            raise InvalidWorldError(f"zone {self.label!r}: low must be below high in x and in y")


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
        self.labels = tuple(dict.fromkeys(zone.label for zone in self.zones))
        numbers = {label: number for number, label in enumerate(self.labels)}
        # one entry more than there are zones: index -1 reads "no zone here"
        self._label = np.array([*(numbers[z.label] for z in self.zones), NOWHERE], dtype=np.intp)
        self._kind = np.array([*(z.kind for z in self.zones), Kind.OBSTACLE], dtype=np.uint8)
        self._low = np.array([zone.low for zone in self.zones], dtype=np.float64)
        self._high = np.array([zone.high for zone in self.zones], dtype=np.float64)
        corners = np.hstack([self._low, self._high])
        self._tree = shapely.STRtree([shapely.box(*corner) for corner in corners])

    def read(self, xy: Floats) -> tuple[Integers, Bytes]:
        """Return label index and kind at each point (ReadMap, R4).

        Points have the shape (..., 2), the answers the shape (...). On a common edge the later
        zone wins; outside all zones the label index is `NOWHERE` and the kind OBSTACLE.
        """
        x, y = xy[..., 0], xy[..., 1]
        top = np.full(x.shape, -1, dtype=np.intp)
        for number in self._zones_near(x, y):
            low, high = self._low[number], self._high[number]
            top[(x >= low[0]) & (x <= high[0]) & (y >= low[1]) & (y <= high[1])] = number
        return self._label[top], self._kind[top]

    def _zones_near(self, x: Floats, y: Floats) -> Integers:
        """Return the numbers of the zones whose rectangle meets that of the points, ascending."""
        if x.size == 0:
            return np.empty(0, dtype=np.intp)
        window = shapely.box(x.min(), y.min(), x.max(), y.max())
        return np.sort(self._tree.query(window))
