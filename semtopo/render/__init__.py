"""Draw a map as the paper's figure 3 does: the zones left, the graph right; SVG as text.

In comes a map; out goes the text of a picture that needs no other file. The same map gives the
same picture.
"""

from __future__ import annotations

import numpy as np
import shapely

from semtopo.mapper import MapState
from semtopo.render import svg
from semtopo.render.drawing import Drawing, Layer
from semtopo.render.frame import frame_around
from semtopo.render.graph_panel import GraphPanel, draw_graph
from semtopo.render.metric_panel import draw_metric_map
from semtopo.render.palette import FAINT, FONTS, INK, PAPER
from semtopo.render.sheet import LEFT, RIGHT, TOP, Box, Sheet, sheet_for
from semtopo.types import Floats

_SMALL = 760.0  # pixels; on narrower pictures, the counts would run into a heading


def render(state: MapState, drawing: Drawing | None = None) -> str:
    """Return the picture of a map as SVG. A map without zones gives a picture that says so."""
    wish = drawing or Drawing()
    graph = draw_graph(state, wish.route) if wish.shows(Layer.GRAPH) else None
    extent = _extent(state, wish)
    sheet = sheet_for(wish, extent, None if graph is None else graph.size)
    width, height = sheet.size
    return svg.element(
        "svg",
        svg.element("rect", width=width, height=height, fill=PAPER),
        "" if sheet.metric is None else _metric(state, wish, extent, sheet.metric),
        "" if sheet.graph is None or graph is None else _graph(graph, sheet.graph),
        _counts(state, width),
        _below(wish, sheet),
        xmlns="http://www.w3.org/2000/svg",
        viewBox=f"0 0 {svg.number(width)} {svg.number(height)}",
        width=width,
        height=height,
        font_family=FONTS,
    )


def _extent(state: MapState, drawing: Drawing) -> Floats:
    """Return points (n, 2) around all that is to be shown; a square metre if that is nothing."""
    regions = [zone.region for zone in state.metric.zones.values()]
    corners = shapely.get_coordinates(
        shapely.box(*shapely.total_bounds(regions)) if regions else []
    )
    line = () if drawing.route is None else drawing.route.line
    others = np.array([*drawing.trail, *drawing.around, *line], dtype=np.float64).reshape(-1, 2)
    points = np.concatenate([corners, others])
    return points if len(points) else np.array([[0.0, 0.0], [1.0, 1.0]])


def _metric(state: MapState, drawing: Drawing, extent: Floats, box: Box) -> str:
    """Return the panel of the metric map in its place."""
    size = (box[2], box[3])
    panel = draw_metric_map(state, drawing, frame_around(extent, size, size))
    if not state.graph.nodes:
        middle = (box[2] / 2, box[3] / 2 - 24)
        panel += svg.text("no zones yet", middle, 20, text_anchor="middle", fill=INK)
    return _panel("Metric map", panel, box)


def _graph(graph: GraphPanel, box: Box) -> str:
    """Return the panel of the graph in its place: in the middle, and no larger than that."""
    left, top, width, height = box
    scale = min(1.0, width / graph.size[0], height / graph.size[1])
    x, y = (width - scale * graph.size[0]) / 2, (height - scale * graph.size[1]) / 2
    moved = f"translate({svg.number(x)} {svg.number(y)})"
    return _panel(
        "Topology graph",
        svg.element("rect", width=width, height=height, fill=PAPER, stroke=FAINT)
        + svg.group(
            graph.content, transform=moved if scale == 1 else f"{moved} scale({scale:.4f})"
        ),
        (left, top, width, height),
    )


def _panel(heading: str, content: str, box: Box) -> str:
    """Return a panel in its place, with its heading."""
    return svg.group(
        content,
        svg.text(heading, (0, -14), 16, font_weight="bold", fill=INK),
        transform=f"translate({svg.number(box[0])} {svg.number(box[1])})",
    )


def _counts(state: MapState, width: float) -> str:
    """Return how much there is, at the top right."""
    if width < _SMALL:
        return ""
    passages, zones = len(state.graph.passages), len(state.graph.nodes)
    words = f"{state.seq} steps, {zones} zones, {passages} passages"
    return svg.text(words, (width - RIGHT, TOP - 14), 13, text_anchor="end", fill=FAINT)


def _below(drawing: Drawing, sheet: Sheet) -> str:
    """Return the legend, and the caption above it."""
    top = sheet.size[1] - sheet.legend_height
    legend = svg.group(sheet.legend, transform=f"translate({LEFT} {svg.number(top)})")
    if not drawing.caption:
        return legend
    return legend + svg.text(drawing.caption, (LEFT, top - 10), 15, fill=INK)
