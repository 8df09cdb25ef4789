"""Draw the topology graph M_s as the paper's figure 3 does on its right: directed and labelled."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from semtopo.graph import Node, Passage
from semtopo.mapper import MapState
from semtopo.render import svg
from semtopo.render.layout import Nodes, lay_out
from semtopo.render.palette import FAINT, INK, PAPER, shade
from semtopo.types import Flags, Floats, Point

_BEND = 10.0  # pixels; the two directions of a link bend to opposite sides
_ARROW = 9.0  # pixels from base to tip
_MARGIN = 0.12  # of the panel's width and height
_ROOM = 75.0  # pixels around each node
_LENGTH_MAX = 18  # signs; the full name is in the title


def draw_graph(state: MapState, height: float) -> tuple[str, Point]:
    """Return the panel of nodes and edges, in the colours of the metric map, and its size.

    It is as high as asked for, in pixels, or higher.
    """
    nodes = list(state.graph.nodes.values())
    font = 15.0 if len(nodes) <= 12 else 11.0  # noqa: PLR2004 -- what stays legible
    half = np.array([_half_size(node, font) for node in nodes]).reshape(-1, 2)
    size = _panel_size(half, height)
    number = {node.zone_id: place for place, node in enumerate(nodes)}
    ends = [(number[edge.source], number[edge.target]) for edge in state.graph.passages.values()]
    links = np.array(sorted({(min(pair), max(pair)) for pair in ends}), dtype=np.intp)
    middles = lay_out(Nodes(_homes(state, size), half, links.reshape(-1, 2)), size)
    panel = "".join(
        [
            svg.element("rect", width=size[0], height=size[1], fill=PAPER, stroke=FAINT),
            *_edges(state.graph.passages.values(), ends, middles, half),
            *_nodes(nodes, middles, half, font),
        ]
    )
    return panel, size


def _panel_size(half: Floats, height: float) -> Point:
    """Return the size in pixels that leaves nodes of half sizes (nodes, 2) room for edges."""
    needed = float((2 * half + _ROOM).prod(axis=1).sum())
    width = max(520.0, math.sqrt(needed))
    return (width, max(320.0, height, needed / width))


def _half_size(node: Node, font: float) -> Point:
    """Return half the width and height of a node."""
    width = svg.text_width(svg.shortened(node.label, _LENGTH_MAX)) * font
    return (max(width / 2 + 0.7 * font, 1.2 * font), 1.2 * font)


def _homes(state: MapState, size: Point) -> Floats:
    """Return where the nodes would like to be, (nodes, 2): as their zones lie, spread out."""
    zones = state.metric.zones
    centres = [zones[node].region.centroid.coords[0] for node in state.graph.nodes]
    places = np.array(centres).reshape(-1, 2) * (1, -1)  # y points up on the map
    if len(places) == 0:
        return places
    low, extent = places.min(axis=0), np.ptp(places, axis=0)
    share = np.where(extent > 0, (places - low) / np.where(extent > 0, extent, 1), 0.5)
    spread: Floats = (_MARGIN + share * (1 - 2 * _MARGIN)) * np.array(size)
    return spread


def _nodes(nodes: Sequence[Node], middles: Floats, half: Floats, font: float) -> Iterator[str]:
    """Yield the nodes, with their labels."""
    for number, (node, (x, y), (across, down)) in enumerate(zip(nodes, middles, half, strict=True)):
        yield svg.element(
            "rect",
            svg.title(node.label),
            x=x - across,
            y=y - down,
            width=2 * across,
            height=2 * down,
            rx=down,
            fill=shade(number).area,
            stroke=shade(number).line,
            stroke_width=1.5,
        )
        words = svg.shortened(node.label, _LENGTH_MAX)
        yield svg.text(words, (x, y + 0.35 * font), font, text_anchor="middle", fill=INK)


def _edges(
    passages: Iterable[Passage], ends: Sequence[tuple[int, int]], middles: Floats, half: Floats
) -> Iterator[str]:
    """Yield the edges, each in the colour of its source."""
    pairs = set(ends)
    for passage, (source, target) in zip(passages, ends, strict=True):
        bend = _BEND if (target, source) in pairs else 0.0
        curve = _between(middles[[source, target]], half[[source, target]], bend)
        x, y = passage.point
        words = f"{passage.source} \u2192 {passage.target} at ({x:.2f}, {y:.2f})"
        colour = shade(source).line
        yield svg.group(
            svg.title(words),
            svg.element("path", d=_line_data(curve), fill="none", stroke=colour, stroke_width=1.5),
            svg.element("path", d=_head_data(curve), fill=colour),
        )


def _between(middles: Floats, half: Floats, bend: float) -> Floats:
    """Return a quadratic curve (3, 2) from the border of one node to that of another.

    It bends by so many pixels to the right of its way: the way back lies on the other side.
    """
    start, end = middles
    along = end - start
    right = np.array([-along[1], along[0]]) / max(np.hypot(*along), 1e-9)
    middle = (start + end) / 2 + 2 * bend * right
    share = np.linspace(0, 1, 201)[:, None]
    curve = (1 - share) ** 2 * start + 2 * share * (1 - share) * middle + share**2 * end
    outside = ~_within(curve, start, half[0] + 1) & ~_within(curve, end, half[1] + 3)
    if not outside.any():  # the nodes touch
        return np.array([start, middle, end])
    first, last = share[outside][[0, -1], 0]
    turn = (
        (1 - first) * (1 - last) * start
        + (first + last - 2 * first * last) * middle
        + first * last * end
    )
    return np.array([curve[outside][0], turn, curve[outside][-1]])


def _within(curve: Floats, middle: Floats, half: Floats) -> Flags:
    """Say of each point (n, 2) whether it lies in a node, whose ends are half circles."""
    core = np.array([half[0] - half[1], 0.0])
    beyond = np.maximum(np.abs(curve - middle) - core, 0)
    within: Flags = np.hypot(*beyond.T) <= half[1]
    return within


def _line_data(curve: Floats) -> str:
    """Return the path of an edge; it ends within its arrow head."""
    start, middle, end = curve
    stop = end - _ARROW / 2 * _direction(curve)
    return f"M{svg.points(np.array([start]))}Q{svg.points(np.array([middle, stop]))}"


def _head_data(curve: Floats) -> str:
    """Return the path of an arrow head."""
    tip, along = curve[2], _direction(curve)
    side = np.array([-along[1], along[0]]) * _ARROW * 0.42
    base = tip - _ARROW * along
    return f"M{svg.points(np.array([tip, base + side, base - side]))}Z"


def _direction(curve: Floats) -> Floats:
    """Return the unit vector along which a curve arrives."""
    arriving = curve[2] - curve[1]
    direction: Floats = arriving / max(np.hypot(*arriving), 1e-9)
    return direction
