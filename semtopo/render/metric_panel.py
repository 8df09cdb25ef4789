"""Draw the metric map M_m as the paper's figure 3 does on its left: the unexplored is dim."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np
import shapely
from shapely import LineString, MultiLineString

from semtopo.borders import border_pieces
from semtopo.geometry import Region
from semtopo.graph import Passage
from semtopo.mapper import MapState
from semtopo.metric import MappedZone
from semtopo.render import svg
from semtopo.render.axes import draw_axes
from semtopo.render.drawing import Drawing, Layer
from semtopo.render.frame import Frame
from semtopo.render.labels import NamedRegion, place_labels
from semtopo.render.marks import ROUTE_HALF, frontier_line, passage_mark, route_ends, route_line
from semtopo.render.palette import DIM, DOORWAY, HALO, INK, OCCUPANCY, shade
from semtopo.types import Floats, Occupancy, Point

DOT = 2.8  # pixels; the diameter of a border point
_TITLES_MAX = 5_000  # passages; more are one shape, without a title for each
_FINEST = 0.25  # pixels; a bend that is smaller does not show


def draw_metric_map(state: MapState, drawing: Drawing, frame: Frame) -> str:
    """Return the panel of the layers that are to be shown."""
    zones = list(state.metric.zones.values())
    width, height = frame.size
    layers = {
        Layer.DOORWAYS: _doorways(state, frame),
        Layer.ZONES: _areas(zones, frame),
        Layer.FRONTIERS: _frontiers(zones, frame),
        Layer.BORDERS: _borders(zones, frame),
        Layer.TRAIL: _trail(drawing.trail, frame),
        Layer.PASSAGES: _passages(list(state.graph.passages.values()), frame),
        Layer.ROBOT: _robot(state, drawing.trail, frame),
        Layer.LABELS: _names(zones, drawing, frame),
    }
    shown = [mark for layer, marks in layers.items() if drawing.shows(layer) for mark in marks]
    return "".join(
        [
            svg.element("rect", width=width, height=height, fill=DIM),
            *shown,
            *_route(drawing, frame),
            draw_axes(frame, is_numbered=drawing.shows(Layer.AXES)),
        ]
    )


def _areas(zones: Sequence[MappedZone], frame: Frame) -> Iterator[str]:
    """Yield the regions of all zones."""
    for number, zone in enumerate(zones):
        yield svg.element(
            "path",
            svg.title(f"{zone.zone_id}: {zone.region.area:.2f} m\u00b2"),
            d="".join(f"M{svg.points(ring)}Z" for ring in _rings(zone.region, frame)),
            fill=shade(number).area,
            fill_rule="evenodd",
            stroke=shade(number).line,
            stroke_width=0.8,
            stroke_linejoin="round",
        )


def _doorways(state: MapState, frame: Frame) -> Iterator[str]:
    """Yield the ground between zones."""
    for doorway in state.metric.doorways.values():
        data = "".join(f"M{svg.points(ring)}Z" for ring in _rings(doorway.region, frame))
        words = " \u2013 ".join(doorway.ends)
        yield svg.element("path", svg.title(words), d=data, fill=DOORWAY, fill_rule="evenodd")


def _rings(region: Region, frame: Frame) -> Iterator[Floats]:
    """Yield every ring of a region in pixels without its last point; bends too fine are cut."""
    dots = shapely.transform(region, frame.pixels)
    coarse = dots.simplify(_FINEST, preserve_topology=False)
    for part in shapely.get_parts(dots if coarse.is_empty else coarse):
        for ring in shapely.get_rings(part):
            yield shapely.get_coordinates(ring)[:-1]


def _frontiers(zones: Sequence[MappedZone], frame: Frame) -> Iterator[str]:
    """Yield the stretches of border beyond which nothing is known."""
    for zone in zones:
        for piece in border_pieces(zone):
            if piece.occupancy is Occupancy.FREE:
                yield frontier_line(svg.points(frame.pixels(piece.line)))


def _borders(zones: Sequence[MappedZone], frame: Frame) -> Iterator[str]:
    """Yield the border points of all zones, one path for each occupancy."""
    points = [zone.border.points() for zone in zones]
    for meaning, colour in OCCUPANCY.items():
        chosen = [xy[occupancy == meaning] for xy, occupancy in points]
        dots = _thinned(frame.pixels(np.concatenate([np.empty((0, 2)), *chosen])))
        if len(dots):
            yield svg.element(
                "path", d=svg.dots(dots), stroke=colour, stroke_width=DOT, stroke_linecap="round"
            )


def _thinned(dots: Floats) -> Floats:
    """Return (n, 2) points, only the first of those in one square of half a dot's size."""
    _, first = np.unique(np.floor(dots / (DOT / 2)), axis=0, return_index=True)
    return dots[np.sort(first)]


def _trail(trail: Sequence[Point], frame: Frame) -> Iterator[str]:
    """Yield the line along which the robot went."""
    if trail:
        line = svg.points(frame.pixels(np.array(trail)))
        yield svg.element(
            "polyline", points=line, fill="none", stroke=INK, stroke_width=1, opacity=0.7
        )


def _robot(state: MapState, trail: Sequence[Point], frame: Frame) -> Iterator[str]:
    """Yield the robot, at the end of its trail, looking along its last move."""
    places = [*trail] or ([] if state.position is None else [state.position])
    if not places:
        return
    dots = frame.pixels(np.array(places))
    at = dots[-1]
    x, y = at + 6 * _heading(dots)
    yield svg.element("circle", cx=at[0], cy=at[1], r=6, fill=INK, stroke=HALO)
    yield svg.line((at[0], at[1]), (x, y), stroke=HALO, stroke_width=2)


def _heading(dots: Floats) -> Floats:
    """Return the unit vector of the last move of a trail (n, 2), zero if there was none."""
    moves = np.diff(dots, axis=0)
    moves = moves[np.hypot(*moves.T) > 0]
    return moves[-1] / math.hypot(*moves[-1]) if len(moves) else np.zeros(2)


def _route(drawing: Drawing, frame: Frame) -> Iterator[str]:
    """Yield the line of a route, with a ring where it begins and a disc where it ends."""
    if drawing.route is None or not drawing.route.line:
        return
    dots = frame.pixels(np.array(drawing.route.line))
    yield route_line(svg.points(dots))
    yield route_ends(dots)


def _passages(passages: Sequence[Passage], frame: Frame) -> Iterator[str]:
    """Yield the marks of all passage points; small ones where there are very many."""
    room = frame.size[0] * frame.size[1] / (len(passages) + 1)
    half = min(max(math.sqrt(room) / 8, 1.5), 5.0)
    if len(passages) > _TITLES_MAX:
        marks = [passage_mark(frame.pixel(passage.point), half) for passage in passages]
        yield svg.element("path", d="".join(marks), fill=OCCUPANCY[Occupancy.PASSAGE])
        return
    for passage in passages:
        x, y = passage.point
        yield svg.element(
            "path",
            svg.title(f"{passage.source} \u2192 {passage.target} at ({x:.2f}, {y:.2f})"),
            d=passage_mark(frame.pixel(passage.point), half),
            fill=OCCUPANCY[Occupancy.PASSAGE],
            stroke=INK,
            stroke_width=half / 5,
        )


def _names(zones: Sequence[MappedZone], drawing: Drawing, frame: Frame) -> Iterator[str]:
    """Yield the name of each zone that has room for it."""
    named = [NamedRegion(it.zone_id, shapely.transform(it.region, frame.pixels)) for it in zones]
    trail = _line(drawing.trail if drawing.shows(Layer.TRAIL) else (), frame)
    route = _line(() if drawing.route is None else drawing.route.line, frame)
    lines = MultiLineString([line for line in (trail, route) if not line.is_empty])
    for label in place_labels(named, lines, route.buffer(ROUTE_HALF), frame.size):
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


def _line(points: Sequence[Point], frame: Frame) -> LineString:
    """Return a line in pixels; of a single point, a line to itself."""
    return LineString(frame.pixels(np.array([*points, *points[-1:]])) if points else [])
