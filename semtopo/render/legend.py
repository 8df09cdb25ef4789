"""Say what the marks of a picture mean, in as many lines as that takes."""

from __future__ import annotations

from collections.abc import Iterator

from semtopo.render import svg
from semtopo.render.drawing import Drawing, Layer
from semtopo.render.marks import frontier_line, passage_mark, route_line
from semtopo.render.palette import DIM, DOORWAY, HALO, INK, OCCUPANCY
from semtopo.types import Occupancy

_SIZE = 12.0
_MARK = 14.0  # pixels from the middle of a mark to its words
_GAP = 26.0
_LINE = 22.0


def draw_legend(drawing: Drawing, width: float) -> tuple[str, float]:
    """Return the marks that a drawing shows with their meanings, from the origin on, and a height.

    There are as many lines as the width in pixels makes necessary; without a legend, none.
    """
    if not drawing.shows(Layer.LEGEND):
        return "", 0.0
    parts, left, top = [], 8.0, 10.0
    for mark, words in _entries(drawing):
        length = _MARK + svg.text_width(words) * _SIZE
        if left > 8.0 and left + length > width:  # noqa: PLR2004 -- not the first of its line
            left, top = 8.0, top + _LINE
        label = svg.text(words, (_MARK, 4), _SIZE, fill=INK)
        place = f"translate({svg.number(left)} {svg.number(top)})"
        parts.append(svg.group(mark, label, transform=place))
        left += length + _GAP
    return "".join(parts), top + _LINE


def _entries(drawing: Drawing) -> Iterator[tuple[str, str]]:
    """Yield the marks and what they mean."""
    marks: dict[Layer, list[tuple[str, str]]] = {
        Layer.BORDERS: [
            (svg.element("circle", r=3.5, fill=colour), f"border: {meaning.name.lower()}")
            for meaning, colour in OCCUPANCY.items()
        ],
        Layer.FRONTIERS: [(frontier_line("-9,0 9,0"), "frontier")],
        Layer.PASSAGES: [(_diamond(), "passage point")],
        Layer.DOORWAYS: [(_square(DOORWAY), "doorway")],
        Layer.TRAIL: [(svg.line((-9, 0), (9, 0), stroke=INK), "trail")],
        Layer.ROBOT: [(svg.element("circle", r=6, fill=INK, stroke=HALO), "robot")],
    }
    for layer, entries in marks.items():
        yield from entries if drawing.shows(layer) else ()
    if drawing.route is not None:
        yield route_line("-10,0 10,0"), "route"
    if drawing.layers - {Layer.GRAPH, Layer.LEGEND}:
        yield _square(DIM), "unexplored"


def _square(colour: str) -> str:
    return svg.element("rect", x=-7, y=-7, width=14, height=14, fill=colour)


def _diamond() -> str:
    return svg.element(
        "path", d=passage_mark((0, 0)), fill=OCCUPANCY[Occupancy.PASSAGE], stroke=INK
    )
