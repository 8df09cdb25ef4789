"""Say in a line what the marks of the metric map mean."""

from __future__ import annotations

from semtopo.render import svg
from semtopo.render.metric_panel import passage_mark
from semtopo.render.palette import DIM, HALO, INK, OCCUPANCY
from semtopo.types import Occupancy

_SIZE = 12.0
_MARK = 14.0  # pixels from the middle of a mark to its words
_GAP = 26.0


def draw_legend() -> str:
    """Return the marks with their meanings, in a line that starts at the origin."""
    entries = [
        *(
            (_dot(colour), f"border: {meaning.name.lower()}")
            for meaning, colour in OCCUPANCY.items()
        ),
        (_diamond(), "passage point"),
        (_robot(), "path and robot"),
        (svg.element("rect", x=-7, y=-7, width=14, height=14, fill=DIM), "unexplored"),
    ]
    parts, left = [], 8.0
    for mark, words in entries:
        label = svg.text(words, (_MARK, 4), _SIZE, fill=INK)
        parts.append(svg.group(mark, label, transform=f"translate({svg.number(left)} 0)"))
        left += _MARK + svg.text_width(words) * _SIZE + _GAP
    return "".join(parts)


def _dot(colour: str) -> str:
    return svg.element("circle", r=3.5, fill=colour)


def _diamond() -> str:
    return svg.element(
        "path", d=passage_mark((0, 0)), fill=OCCUPANCY[Occupancy.PASSAGE], stroke=INK
    )


def _robot() -> str:
    line = svg.line((-12, 0), (0, 0), stroke=INK)
    return line + svg.element("circle", r=6, fill=INK, stroke=HALO)
