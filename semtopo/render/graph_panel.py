"""Draw the topology graph M_s as the paper's figure 3 does on its right: directed and labelled."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from semtopo.graph import Node, Passage, PassageKey
from semtopo.mapper import MapState
from semtopo.render import svg
from semtopo.render.drawing import DrawnRoute
from semtopo.render.layout import Nodes, lay_out
from semtopo.render.palette import FAINT, INK, ROUTE, shade
from semtopo.types import Flags, Floats, Point

NODES_MAX, EDGES_MAX = 1_500, 6_000
"""A graph beyond that is a grey cloud on paper, and takes seconds to draw."""

_BEND = 10.0  # pixels; the two directions of a link bend to opposite sides
_ARROW = 9.0  # pixels from base to tip
_MARGIN = 0.12  # of the panel's width and height
_ROOM = 75.0  # pixels around each node
_EDGE = 18.0  # pixels around all nodes
_LEAST = (480.0, 480.0)  # pixels
_UPRIGHT, _WIDE = 0.6, 1.6  # width as a multiple of the height
_LENGTH_MAX = 18  # signs; the full name is in the title


@dataclass(frozen=True, slots=True)
class GraphPanel:
    """The drawing of a graph from the origin on, and its size in pixels."""

    content: str
    size: Point


def draw_graph(state: MapState, route: DrawnRoute | None) -> GraphPanel:
    """Return the panel of nodes and edges, in the colours of the metric map."""
    nodes = list(state.graph.nodes.values())
    if len(nodes) > NODES_MAX or len(state.graph.passages) > EDGES_MAX:
        words = f"{len(nodes)} zones and {len(state.graph.passages)} passages: too many to draw"
        middle = (_LEAST[0] / 2, _LEAST[1] / 2)
        return GraphPanel(svg.text(words, middle, 15, text_anchor="middle", fill=FAINT), _LEAST)
    font = 15.0 if len(nodes) <= 12 else 11.0  # noqa: PLR2004 -- what stays legible
    half = np.array([_half_size(node, font) for node in nodes]).reshape(-1, 2)
    number = {node.zone_id: place for place, node in enumerate(nodes)}
    edges = [
        _Edge(edge, number[edge.source], number[edge.target])
        for edge in state.graph.passages.values()
    ]
    pairs = sorted({(min(edge.ends), max(edge.ends)) for edge in edges})
    links = np.array(pairs, dtype=np.intp).reshape(-1, 2)
    room = _room(state, half)
    middles = lay_out(Nodes(_homes(state, room), half, links), room)
    middles, size = _cropped(middles, half)
    taken = frozenset() if route is None else route.passages
    marks = [*_edges(edges, middles, half, taken), *_nodes(nodes, middles, half, font)]
    return GraphPanel("".join(marks), size)


@dataclass(frozen=True, slots=True)
class _Edge:
    """A passage, and the numbers of the nodes that it joins."""

    passage: Passage
    source: int
    target: int

    @property
    def ends(self) -> tuple[int, int]:
        """The numbers of its source and target."""
        return (self.source, self.target)


def _room(state: MapState, half: Floats) -> Point:
    """Return the size in pixels that leaves nodes of half sizes (nodes, 2) room for edges.

    It is as wide or upright as the map, within reason.
    """
    if len(half) == 0:
        return _LEAST
    needed = max(float((2 * half + _ROOM).prod(axis=1).sum()), _LEAST[0] * _LEAST[1])
    bounds = shapely.total_bounds([zone.region for zone in state.metric.zones.values()])
    extent = bounds[2:] - bounds[:2]
    shape = math.sqrt(min(max(extent[0] / max(extent[1], 1e-9), _UPRIGHT), _WIDE))
    return (math.sqrt(needed) * shape, math.sqrt(needed) / shape)


def _cropped(middles: Floats, half: Floats) -> tuple[Floats, Point]:
    """Return places of nodes (nodes, 2) moved to the origin, and the size that they fill."""
    if len(middles) == 0:
        return middles, _LEAST
    low, high = (middles - half).min(axis=0) - _EDGE, (middles + half).max(axis=0) + _EDGE
    width, height = high - low
    return middles - low, (float(width), float(height))


def _half_size(node: Node, font: float) -> Point:
    """Return half the width and height of a node."""
    width = svg.text_width(svg.shortened(node.zone_id, _LENGTH_MAX)) * font
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
            svg.title(node.zone_id),
            x=x - across,
            y=y - down,
            width=2 * across,
            height=2 * down,
            rx=down,
            fill=shade(number).area,
            stroke=shade(number).line,
            stroke_width=1.5,
        )
        words = svg.shortened(node.zone_id, _LENGTH_MAX)
        yield svg.text(words, (x, y + 0.35 * font), font, text_anchor="middle", fill=INK)


def _edges(
    edges: Sequence[_Edge], middles: Floats, half: Floats, route: frozenset[PassageKey]
) -> Iterator[str]:
    """Yield the edges, each in the colour of its source; those of a route last, and bold."""
    ways = {edge.ends for edge in edges} | {
        edge.ends[::-1] for edge in edges if edge.passage.number > 0
    }
    for edge in sorted(edges, key=lambda edge: edge.passage.key in route):
        is_alone = edge.ends[::-1] not in ways
        bend = 0.0 if is_alone else _BEND * (1 + 2 * edge.passage.number)
        ends = [edge.source, edge.target]
        curve = _between(middles[ends], half[ends], bend)
        x, y = edge.passage.point
        words = f"{edge.passage.source} \u2192 {edge.passage.target} at ({x:.2f}, {y:.2f})"
        is_taken = edge.passage.key in route
        colour, width = (ROUTE, 3.5) if is_taken else (shade(edge.source).line, 1.5)
        line = svg.element(
            "path", d=_line_data(curve), fill="none", stroke=colour, stroke_width=width
        )
        head = svg.element("path", d=_head_data(curve), fill=colour)
        yield svg.group(svg.title(words), line, head)


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
