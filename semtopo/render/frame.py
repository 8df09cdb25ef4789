"""From the map frame (m, y up) to a panel (pixels, y down), with ticks in round numbers."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from semtopo.types import Floats, Point


@dataclass(frozen=True, slots=True)
class Frame:
    """A window of the map, from `low` in m on, as a panel of `size` pixels at `scale` per m."""

    low: Point
    scale: float
    size: Point

    def pixels(self, xy: Floats) -> Floats:
        """Return (n, 2) points in m as pixels of the panel."""
        across = (xy[:, 0] - self.low[0]) * self.scale
        down = self.size[1] - (xy[:, 1] - self.low[1]) * self.scale
        return np.stack([across, down], axis=-1)

    def pixel(self, point: Point) -> Point:
        """Return a point in m as a pixel of the panel."""
        x, y = self.pixels(np.array([point]))[0]
        return (float(x), float(y))

    def ticks(self, axis: int) -> list[float]:
        """Return round numbers in m in the window along x (0) or y (1), about 60 pixels apart."""
        step = round_length(60 / self.scale)
        low, extent = self.low[axis], self.size[axis] / self.scale
        first, last = math.ceil(low / step), math.floor((low + extent) / step)
        return [number * step for number in range(first, last + 1)]


def frame_around(xy: Floats, least: Point, most: Point) -> Frame:
    """Return a frame that shows all of (n, 2) points in m, n > 0, with room to spare.

    The panel is no larger than `most` pixels and no smaller than `least`.
    """
    low, high = xy.min(axis=0), xy.max(axis=0)
    margin = max(0.05 * float((high - low).max()), 0.5)  # m
    low, high = low - margin, high + margin
    scale = float((np.array(most) / (high - low)).min())
    size = np.maximum((high - low) * scale, least)
    low = (low + high - size / scale) / 2
    return Frame((float(low[0]), float(low[1])), scale, (float(size[0]), float(size[1])))


def round_length(length: float) -> float:
    """Return the least of 1, 2, 5 times a power of ten that is not below a length above 0."""
    power = 10.0 ** math.floor(math.log10(length))
    return next(step * power for step in (1.0, 2.0, 5.0, 10.0) if step * power >= length)
