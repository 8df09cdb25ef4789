"""Divide a picture among its panels: the metric map left or above, the graph right or below."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

from semtopo.render.drawing import SIDE_MAX, SIDE_MIN, Drawing, Layer
from semtopo.render.frame import frame_around
from semtopo.render.legend import draw_legend
from semtopo.types import Floats, Point

Box: TypeAlias = tuple[float, float, float, float]
"""Left, top, width and height of a panel, in pixels."""

LEFT, TOP, RIGHT, BOTTOM = 52.0, 52.0, 12.0, 50.0
"""Pixels around the panels, for headings and the numbers of the axes."""

CAPTION = 24.0
"""Pixels, for the line of a caption."""

_BETWEEN = 36.0  # pixels between panels side by side
_METRIC_LEAST, _METRIC_MOST = (420.0, 320.0), (760.0, 640.0)
_GRAPH_LEAST = (420.0, 320.0)
_SHARE_LEAST, _SHARE_MOST = 0.42, 0.66  # of the panels, for the metric map
_UPRIGHT = 1.1  # times its height; on a narrower sheet, the graph lies below the map
_STACKED = 700.0  # pixels; narrower than that, panels side by side are too small
_INNER_LEAST = 60.0  # pixels


@dataclass(frozen=True, slots=True)
class Sheet:
    """A picture's size, where its panels lie, and its legend; what is not shown is not there."""

    size: Point
    metric: Box | None
    graph: Box | None
    legend: str
    legend_height: float


def sheet_for(drawing: Drawing, extent: Floats, graph: Point | None) -> Sheet:
    """Return the sheet for points (n, 2) in m to be shown, and a graph of some size in pixels."""
    panels = _panels(drawing, extent, graph)
    size = _size(drawing, panels)
    legend, height = draw_legend(drawing, size[0] - LEFT - RIGHT)
    below = BOTTOM + height + _caption(drawing)
    room = (
        max(size[0] - LEFT - RIGHT, _INNER_LEAST),
        max(size[1] - TOP - below, _INNER_LEAST),
    )
    boxes = _boxes(room, [width for width, _ in panels])
    metric = None if _only_graph(drawing) else boxes[0]
    return Sheet(size, metric, None if graph is None else boxes[-1], legend, height)


def _only_graph(drawing: Drawing) -> bool:
    """Say whether there is no metric map at all to be seen."""
    return drawing.shows(Layer.GRAPH) and drawing.layers <= {Layer.GRAPH, Layer.LEGEND}


def _panels(drawing: Drawing, extent: Floats, graph: Point | None) -> list[Point]:
    """Return the sizes that the panels would like to have, one or two of them."""
    wide, high = _GRAPH_LEAST if graph is None else map(max, _GRAPH_LEAST, graph)
    if graph is not None and _only_graph(drawing):
        return [(wide, high)]
    most = (max(_METRIC_MOST[0], wide), max(_METRIC_MOST[1], high))
    if graph is None:
        return [frame_around(extent, _METRIC_LEAST, most).size]
    metric = frame_around(extent, (_METRIC_LEAST[0], max(_METRIC_LEAST[1], high)), most).size
    return [metric, (wide, metric[1])]


def _size(drawing: Drawing, panels: Sequence[Point]) -> Point:
    """Return the size of a picture; where one side was asked for, the other one follows."""
    wide, high = drawing.width, drawing.height
    if wide is not None and high is not None:
        return (float(wide), float(high))
    across = sum(width for width, _ in panels) + _BETWEEN * (len(panels) - 1)
    inner_high = max(height for _, height in panels)
    if wide is not None or across + LEFT + RIGHT > SIDE_MAX:
        return _size_of_width(drawing, float(wide or SIDE_MAX), panels)
    if high is None:
        width = across + LEFT + RIGHT
        return (width, _bounded(inner_high + _margins(drawing, width)))
    inner = max(high - _margins(drawing, across + LEFT + RIGHT), _INNER_LEAST)
    return (_bounded(across * inner / inner_high + LEFT + RIGHT), float(high))


def _size_of_width(drawing: Drawing, width: float, panels: Sequence[Point]) -> Point:
    """Return the size of a picture that is so wide: the panels side by side, or stacked."""
    inner = max(width - LEFT - RIGHT, _INNER_LEAST)
    heights = [inner * high / wide for wide, high in panels]
    if width < _STACKED:
        high = sum(heights) + (len(panels) - 1) * (TOP + BOTTOM)
    else:
        high = inner * max(high for _, high in panels) / sum(wide for wide, _ in panels)
    return (width, _bounded(high + _margins(drawing, width)))


def _bounded(side: float) -> float:
    """Return a side in whole pixels, within what a picture may have."""
    return float(min(max(round(side), SIDE_MIN), SIDE_MAX))


def _margins(drawing: Drawing, width: float) -> float:
    """Return the pixels above and below the panels of a picture that is so wide."""
    _, legend = draw_legend(drawing, width - LEFT - RIGHT)
    return TOP + BOTTOM + legend + _caption(drawing)


def _caption(drawing: Drawing) -> float:
    return CAPTION if drawing.caption else 0.0


def _boxes(room: Point, widths: list[float]) -> list[Box]:
    """Return where one or two panels lie that would like to have these widths."""
    width, height = room
    if len(widths) == 1:
        return [(LEFT, TOP, width, height)]
    share = min(max(widths[0] / sum(widths), _SHARE_LEAST), _SHARE_MOST)
    if width >= max(_UPRIGHT * height, _STACKED - LEFT - RIGHT):
        first = (width - _BETWEEN) * share
        second = width - _BETWEEN - first
        return [(LEFT, TOP, first, height), (LEFT + first + _BETWEEN, TOP, second, height)]
    between = TOP + BOTTOM
    first = max(height - between, 2 * _INNER_LEAST) / 2
    return [(LEFT, TOP, width, first), (LEFT, TOP + first + between, width, first)]
