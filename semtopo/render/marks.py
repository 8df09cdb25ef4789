"""The marks that stand on the metric map and in the legend alike."""

from __future__ import annotations

from semtopo.render import svg
from semtopo.render.palette import FRONTIER, HALO, ROUTE
from semtopo.types import Floats, Point

ROUTE_HALF = 7.0
"""Pixels from the middle of a route, or of the marks at its ends, to where they surely end."""


def passage_mark(at: Point, half: float = 5.0) -> str:
    """Return the outline of the mark of a passage point, a square on its corner; in pixels."""
    x, y, step = svg.number(at[0]), svg.number(at[1] - half), svg.number(half)
    return f"M{x} {y}l{step} {step}l-{step} {step}l-{step}-{step}Z"


def frontier_line(points: str) -> str:
    """Return a stretch of border beyond which nothing is known."""
    return svg.element(
        "polyline", points=points, fill="none", stroke=FRONTIER, stroke_width=3,
        stroke_dasharray="6 4", stroke_linejoin="round",
    )  # fmt: skip


def route_line(points: str) -> str:
    """Return the line of a route, light around so that it stays visible on any colour."""
    shared: dict[str, str | float] = {
        "points": points, "fill": "none", "stroke_linejoin": "round", "stroke_linecap": "round",
    }  # fmt: skip
    wide = svg.element("polyline", **shared, stroke=HALO, stroke_width=7)
    return wide + svg.element("polyline", **shared, stroke=ROUTE, stroke_width=4)


def route_ends(dots: Floats) -> str:
    """Return the marks where a route (n, 2) begins and ends: a ring and a disc."""
    (start_x, start_y), (end_x, end_y) = dots[0], dots[-1]
    ring = svg.element(
        "circle", cx=start_x, cy=start_y, r=5, fill=HALO, stroke=ROUTE, stroke_width=3
    )
    return ring + svg.element(
        "circle", cx=end_x, cy=end_y, r=6, fill=ROUTE, stroke=HALO, stroke_width=2
    )
