"""Draw a map as the paper's figure 3 does: the zones left, the graph right; SVG as text.

In comes a map; out goes the text of a picture that needs no other file. The same map gives the
same picture.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from semtopo.mapper import MapState
from semtopo.render import svg
from semtopo.render.frame import frame_around
from semtopo.render.graph_panel import draw_graph
from semtopo.render.legend import draw_legend
from semtopo.render.metric_panel import draw_metric_map
from semtopo.render.palette import FAINT, INK, PAPER
from semtopo.types import Floats, Point

_LEAST, _MOST = (420.0, 320.0), (760.0, 640.0)  # pixels; of the metric map
_LEFT, _TOP, _BETWEEN, _BOTTOM = 52.0, 52.0, 36.0, 84.0
_FONTS = "Helvetica, Arial, 'DejaVu Sans', sans-serif"


def render(state: MapState, *, path: Sequence[Point] = ()) -> str:
    """Return the picture of a map, and of the path in m, map frame, on which it was made.

    The robot stands at the end of the path. A map without zones gives a picture that says so.
    """
    frame = frame_around(_extent(state, path), _LEAST, _MOST)
    graph, graph_size = draw_graph(state, frame.size[1])
    right = _LEFT + frame.size[0] + _BETWEEN
    width, height = right + graph_size[0] + 12, _TOP + graph_size[1] + _BOTTOM
    return svg.element(
        "svg",
        svg.element("rect", width=width, height=height, fill=PAPER),
        _panel("Metric map", draw_metric_map(state, path, frame), _LEFT),
        _panel("Topology graph", graph, right),
        _counts(state, width),
        "" if state.graph.nodes else _no_zones(frame.size),
        svg.group(draw_legend(), transform=f"translate({_LEFT} {svg.number(height - 22)})"),
        xmlns="http://www.w3.org/2000/svg",
        viewBox=f"0 0 {svg.number(width)} {svg.number(height)}",
        width=width,
        height=height,
        font_family=_FONTS,
    )


def _extent(state: MapState, path: Sequence[Point]) -> Floats:
    """Return points (n, 2) around all that is to be shown; a square metre if that is nothing."""
    regions = [zone.region for zone in state.metric.zones.values()]
    corners = shapely.get_coordinates(
        shapely.box(*shapely.total_bounds(regions)) if regions else []
    )
    points = np.concatenate([corners, np.array(path, dtype=np.float64).reshape(-1, 2)])
    return points if len(points) else np.array([[0.0, 0.0], [1.0, 1.0]])


def _panel(heading: str, content: str, left: float) -> str:
    """Return a panel in its place, with its heading."""
    return svg.group(
        content,
        svg.text(heading, (0, -14), 16, font_weight="bold", fill=INK),
        transform=f"translate({svg.number(left)} {svg.number(_TOP)})",
    )


def _counts(state: MapState, width: float) -> str:
    """Return how much there is, at the top right."""
    passages, zones = len(state.graph.passages), len(state.graph.nodes)
    words = f"{state.seq} steps, {zones} zones, {passages} passages"
    return svg.text(words, (width - 12, _TOP - 14), 13, text_anchor="end", fill=FAINT)


def _no_zones(size: Point) -> str:
    """Return the words for an empty map, in the middle of its panel."""
    middle = (_LEFT + size[0] / 2, _TOP + size[1] / 2 - 24)
    return svg.text("no zones yet", middle, 20, text_anchor="middle", fill=INK)
