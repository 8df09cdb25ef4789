"""Find a place for the name of each zone: inside it, as large as fits, off the other names."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from semtopo.geometry import Polygons, Region, polygonal
from semtopo.render import svg
from semtopo.types import Floats, Point

LARGE = (17.0, 15.0, 13.0)
SIZES = (*LARGE, 11.0, 10.0, 9.0, 8.0, 7.0)
"""Font sizes in pixels; the first that fits is taken."""

LENGTH_MAX = 24  # signs; the full name is in the title
_GRID = 13  # places tried along each axis of a zone


@dataclass(frozen=True, slots=True)
class Label:
    """A name, where its middle lies in pixels, and its font size."""

    words: str
    middle: Point
    size: float

    @property
    def box(self) -> BaseGeometry:
        """The rectangle in pixels that the label fills."""
        box: BaseGeometry = _boxes(self.words, np.array([self.middle]), self.size)[0]
        return box


def place_labels(zones: Sequence[tuple[str, Region]], path: BaseGeometry) -> list[Label]:
    """Return a label for each zone, in their order; regions and the robot's path are in pixels.

    Small zones choose first. Large labels keep off the path. Where nothing fits, a label has the
    least size, and lies where it covers others least.
    """
    placed: dict[int, Label] = {}
    for number in sorted(range(len(zones)), key=lambda number: zones[number][1].area):
        region = polygonal(zones[number][1].simplify(1.0))  # a pixel more or less does not show
        words = svg.shortened(zones[number][0], LENGTH_MAX)
        reach = svg.text_width(words) * LARGE[0]
        taken = [label.box for label in placed.values() if label.box.dwithin(region, reach)]
        placed[number] = _place(words, region, shapely.union_all(taken), path)
    return [placed[number] for number in range(len(zones))]


def _place(words: str, region: Region, taken: BaseGeometry, path: BaseGeometry) -> Label:
    """Return the label of one zone, off what is taken if that can be."""
    middles, nothing = _places(region), shapely.Point()
    shapely.prepare([region, taken, path])
    for size, crossed in [*((size, path) for size in LARGE), *((size, nothing) for size in SIZES)]:
        boxes = _boxes(words, middles, size)
        if not _wide_enough(region, boxes[0]):
            continue
        fitting = shapely.contains_properly(region, boxes)
        fitting &= shapely.disjoint(taken, boxes) & shapely.disjoint(crossed, boxes)
        if fitting.any():
            return _label(words, middles[fitting.argmax()], size)
    boxes = _boxes(words, middles, SIZES[-1])
    covered = shapely.area(shapely.intersection(boxes, taken))
    outside = shapely.area(shapely.difference(boxes, region))
    return _label(words, middles[(10 * covered + outside).argmin()], SIZES[-1])


def _wide_enough(region: Region, box: BaseGeometry) -> bool:
    """Say whether a box could fit into a region, by width and height alone; quick."""
    low_x, low_y, high_x, high_y = region.bounds
    left, top, right, bottom = box.bounds
    return bool(right - left < high_x - low_x and bottom - top < high_y - low_y)


def _label(words: str, middle: Floats, size: float) -> Label:
    return Label(words, (float(middle[0]), float(middle[1])), size)


def _places(region: Region) -> Floats:
    """Return places (n, 2) inside a region: its pole, then others, the deepest inside first."""
    pole = shapely.get_coordinates(shapely.maximum_inscribed_circle(region, tolerance=1.0))[:1]
    low_x, low_y, high_x, high_y = region.bounds
    steps = (np.arange(_GRID) + 0.5) / _GRID
    across, up = np.meshgrid(low_x + steps * (high_x - low_x), low_y + steps * (high_y - low_y))
    grid = np.stack([across.ravel(), up.ravel()], axis=-1)
    dots = np.asarray(shapely.points(grid))
    inside = shapely.contains(region, dots)
    depth = shapely.distance(region.boundary, dots)
    return np.concatenate([pole, grid[inside][np.argsort(-depth[inside], kind="stable")]])


def _boxes(words: str, middles: Floats, size: float) -> Polygons:
    """Return the rectangles (n,) that a text fills around each of (n, 2) middles."""
    half = np.array([svg.text_width(words) * size / 2 + 2, size * 0.65])
    low, high = middles - half, middles + half
    return np.asarray(shapely.box(low[:, 0], low[:, 1], high[:, 0], high[:, 1]))
