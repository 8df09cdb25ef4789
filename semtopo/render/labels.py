"""Find a place for the name of each zone: inside it, as large as fits, off the other names."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from shapely import STRtree
from shapely.geometry.base import BaseGeometry

from semtopo.geometry import Polygons, Region, polygonal
from semtopo.render import svg
from semtopo.types import Floats, Point

LARGE = (17.0, 15.0, 13.0)
SIZES = (*LARGE, 12.0, 11.0, 10.0, 9.0)
"""Font sizes in pixels; the first that fits is taken. Smaller ones are hard to read."""

LENGTH_MAX = 24  # signs; the full name is in the title
_GRID = 13  # places tried along each axis of a zone
_AROUND = 9  # places tried along each axis, around a zone that is too small for its name
_CROWD = 300  # zones; among more, a name that does not fit into its zone is left out


@dataclass(frozen=True, slots=True)
class NamedRegion:
    """A zone to be labelled: its name, and its region in pixels."""

    name: str
    region: Region


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


def place_labels(
    zones: Sequence[NamedRegion], lines: BaseGeometry, route: BaseGeometry, panel: Point
) -> list[Label]:
    """Return labels in the order of their zones, none upon another, all within a panel of a size.

    Small zones choose first. Large labels keep off the lines, smaller ones off the route if they
    can. A name that fits nowhere into its zone, in no size, stands in the least one
    beside it, if there is room; else it is left out.
    """
    placed: dict[int, Label] = {}
    order = sorted(range(len(zones)), key=lambda number: zones[number].region.area)
    reach = [_reach(zone) for zone in zones]
    near = STRtree(reach)
    shapely.prepare([lines, route])
    outer = shapely.box(0, 0, *panel)
    for number in order:
        others = [placed[it].box for it in near.query(reach[number]) if it in placed]
        place = _Place(zones[number], shapely.union_all(others), (lines, route))
        label = place.inside() or (place.beside(outer) if len(zones) <= _CROWD else None)
        if label is not None:
            placed[number] = label
    return [placed[number] for number in sorted(placed)]


def _reach(zone: NamedRegion) -> BaseGeometry:
    """Return a box that holds all places where a zone's label may be."""
    low_x, low_y, high_x, high_y = zone.region.bounds
    width = svg.text_width(svg.shortened(zone.name, LENGTH_MAX)) * LARGE[0]
    return shapely.box(low_x - width, low_y - LARGE[0], high_x + width, high_y + LARGE[0])


class _Place:
    """Where the label of one zone may be: off what is taken.

    Large labels keep off the first of `lines`, others off the last.
    """

    def __init__(
        self, zone: NamedRegion, taken: BaseGeometry, lines: tuple[BaseGeometry, BaseGeometry]
    ) -> None:
        self.words = svg.shortened(zone.name, LENGTH_MAX)
        self.region = polygonal(zone.region.simplify(1.0))  # a pixel does not show
        self.taken, self.lines = taken, lines
        shapely.prepare([self.region, taken])

    def inside(self) -> Label | None:
        """Return a label in the zone, as large as fits."""
        if not self._wide_enough(SIZES[-1]):
            return None
        middles, (lines, route) = _places(self.region), self.lines
        wishes = ((LARGE, lines), (SIZES, route), (SIZES, shapely.Point()))
        for size, crossed in ((size, off) for sizes, off in wishes for size in sizes):
            if not self._wide_enough(size):
                continue
            boxes = _boxes(self.words, middles, size)
            fitting = shapely.contains_properly(self.region, boxes)
            fitting &= shapely.disjoint(self.taken, boxes) & shapely.disjoint(crossed, boxes)
            if fitting.any():
                return _label(self.words, middles[fitting.argmax()], size)
        return None

    def beside(self, outer: BaseGeometry) -> Label | None:
        """Return a small label over the border of the zone or next to it, as near as can be."""
        middles = _around(self.region, self.words)
        boxes = _boxes(self.words, middles, SIZES[-1])
        free = shapely.disjoint(self.taken, boxes) & shapely.contains(outer, boxes)
        if not free.any():
            return None
        outside = shapely.area(shapely.difference(boxes[free], self.region))
        return _label(self.words, middles[free][outside.argmin()], SIZES[-1])

    def _wide_enough(self, size: float) -> bool:
        """Say whether a label could fit into the zone, by width and height alone; quick."""
        low_x, low_y, high_x, high_y = self.region.bounds
        left, top, right, bottom = _boxes(self.words, np.zeros((1, 2)), size)[0].bounds
        return bool(right - left < high_x - low_x and bottom - top < high_y - low_y)


def _label(words: str, middle: Floats, size: float) -> Label:
    return Label(words, (float(middle[0]), float(middle[1])), size)


def _around(region: Region, words: str) -> Floats:
    """Return places (n, 2) in a grid about a region, the nearest to its pole first."""
    pole = _pole(region)
    low_x, low_y, high_x, high_y = region.bounds
    reach = np.array([svg.text_width(words) / 2, 0.7]) * SIZES[-1]
    low, high = np.array([low_x, low_y]) - reach, np.array([high_x, high_y]) + reach
    axes = np.linspace(low, high, _AROUND).T
    grid = np.concatenate([pole, np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 2)])
    near: Floats = grid[np.argsort(np.hypot(*(grid - pole).T), kind="stable")]
    return near


def _pole(region: Region) -> Floats:
    """Return the place (1, 2) that lies deepest inside a region."""
    return shapely.get_coordinates(shapely.maximum_inscribed_circle(region, tolerance=1.0))[:1]


def _places(region: Region) -> Floats:
    """Return places (n, 2) inside a region: its pole, then others, the deepest inside first."""
    low_x, low_y, high_x, high_y = region.bounds
    steps = (np.arange(_GRID) + 0.5) / _GRID
    across, up = np.meshgrid(low_x + steps * (high_x - low_x), low_y + steps * (high_y - low_y))
    grid = np.stack([across.ravel(), up.ravel()], axis=-1)
    dots = np.asarray(shapely.points(grid))
    inside = shapely.contains(region, dots)
    depth = shapely.distance(region.boundary, dots)
    order = np.argsort(-depth[inside], kind="stable")
    return np.concatenate([_pole(region), grid[inside][order]])


def _boxes(words: str, middles: Floats, size: float) -> Polygons:
    """Return the rectangles (n,) that a text fills around each of (n, 2) middles."""
    half = np.array([svg.text_width(words) * size / 2 + 2, size * 0.65])
    low, high = middles - half, middles + half
    return np.asarray(shapely.box(low[:, 0], low[:, 1], high[:, 0], high[:, 1]))
