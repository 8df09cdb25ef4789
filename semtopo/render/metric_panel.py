"""Draw the metric map M_m as the paper's figure 3 does on its left: the unexplored is dim."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from semtopo.geometry import Region
from semtopo.graph import Passage
from semtopo.mapper import MapState
from semtopo.metric import MappedZone
from semtopo.render import svg
from semtopo.render.axes import draw_axes
from semtopo.render.frame import Frame
from semtopo.render.labels import place_labels
from semtopo.render.palette import DIM, HALO, INK, OCCUPANCY, shade
from semtopo.types import Floats, Occupancy, Point

DOT = 2.8  # pixels; the diameter of a border point


def draw_metric_map(state: MapState, path: Sequence[Point], frame: Frame) -> str:
    """Return the panel of zones, border points, the robot's path, passages and names."""
    zones = list(state.metric.zones.values())
    width, height = frame.size
    return "".join(
        [
            svg.element("rect", width=width, height=height, fill=DIM),
            *(_area(zone, number, frame) for number, zone in enumerate(zones)),
            *_borders(zones, frame),
            *_drive(path, frame),
            *(_passage(passage, frame) for passage in state.graph.passages.values()),
            *_names(zones, path, frame),
            draw_axes(frame),
        ]
    )


def passage_mark(at: Point) -> str:
    """Return the outline of the mark of a passage point, a square on its corner."""
    x, y = at
    return f"M{svg.number(x)} {svg.number(y - 5)}l5 5l-5 5l-5-5Z"


def _area(zone: MappedZone, number: int, frame: Frame) -> str:
    """Return the region of a zone."""
    rings = [svg.points(frame.pixels(ring)) for ring in _rings(zone.region)]
    return svg.element(
        "path",
        svg.title(f"{zone.label}: {zone.region.area:.2f} m\u00b2"),
        d="".join(f"M{ring}Z" for ring in rings),
        fill=shade(number).area,
        fill_rule="evenodd",
        stroke=shade(number).line,
        stroke_width=0.8,
        stroke_linejoin="round",
    )


def _rings(region: Region) -> Iterator[Floats]:
    """Yield the coordinates of every ring of a region, each without its closing point."""
    for part in shapely.get_parts(region):
        for ring in shapely.get_rings(part):
            yield shapely.get_coordinates(ring)[:-1]


def _borders(zones: Sequence[MappedZone], frame: Frame) -> Iterator[str]:
    """Yield the border points of all zones, one path for each occupancy."""
    for meaning, colour in OCCUPANCY.items():
        chosen = [zone.border.xy[zone.border.occupancy == meaning] for zone in zones]
        dots = _thinned(frame.pixels(np.concatenate([np.empty((0, 2)), *chosen])))
        if len(dots):
            yield svg.element(
                "path", d=svg.dots(dots), stroke=colour, stroke_width=DOT, stroke_linecap="round"
            )


def _thinned(dots: Floats) -> Floats:
    """Return (n, 2) points, only the first of those in one square of half a dot's size."""
    _, first = np.unique(np.floor(dots / (DOT / 2)), axis=0, return_index=True)
    return dots[np.sort(first)]


def _drive(path: Sequence[Point], frame: Frame) -> Iterator[str]:
    """Yield the robot's path, and the robot at its end."""
    if not path:
        return
    dots = frame.pixels(np.array(path))
    yield svg.element(
        "polyline", points=svg.points(dots), fill="none", stroke=INK, stroke_width=1, opacity=0.7
    )
    yield svg.element("circle", cx=dots[-1, 0], cy=dots[-1, 1], r=6, fill=INK, stroke=HALO)
    x, y = dots[-1] + 6 * _heading(dots)
    yield svg.line((dots[-1, 0], dots[-1, 1]), (x, y), stroke=HALO, stroke_width=2)


def _line(path: Sequence[Point], frame: Frame) -> BaseGeometry:
    """Return a path in pixels; a path of one position is a line without length."""
    dots = frame.pixels(np.array([*path, *path[-1:]]).reshape(-1, 2))
    return shapely.LineString(dots)


def _heading(dots: Floats) -> Floats:
    """Return the unit vector of the last move of a path (n, 2), zero if there was none."""
    moves = np.diff(dots, axis=0)
    moves = moves[np.hypot(*moves.T) > 0]
    return moves[-1] / math.hypot(*moves[-1]) if len(moves) else np.zeros(2)


def _passage(passage: Passage, frame: Frame) -> str:
    """Return the mark of a passage point."""
    x, y = passage.point
    return svg.element(
        "path",
        svg.title(f"{passage.source} \u2192 {passage.target} at ({x:.2f}, {y:.2f})"),
        d=passage_mark(frame.pixel(passage.point)),
        fill=OCCUPANCY[Occupancy.PASSAGE],
        stroke=INK,
    )


def _names(zones: Sequence[MappedZone], path: Sequence[Point], frame: Frame) -> Iterator[str]:
    """Yield the name of each zone."""
    named = [(zone.label, shapely.transform(zone.region, frame.pixels)) for zone in zones]
    for label in place_labels(named, _line(path, frame)):
        x, y = label.middle
        yield svg.text(
            label.words,
            (x, y + 0.35 * label.size),
            label.size,
            text_anchor="middle",
            font_weight="bold",
            fill=INK,
            stroke=HALO,
            stroke_width=3,
            stroke_linejoin="round",
            paint_order="stroke",
        )
