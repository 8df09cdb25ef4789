"""Draw around a map panel: its outline, ticks in m left and below, and a scale bar."""

from __future__ import annotations

from collections.abc import Iterator

from semtopo.render import svg
from semtopo.render.frame import Frame, round_length
from semtopo.render.palette import FAINT, INK

_SIZE = 11.0  # of the numbers, in pixels


def draw_axes(frame: Frame, *, is_numbered: bool) -> str:
    """Return the outline of the panel; if it is numbered, ticks and a scale bar too."""
    width, height = frame.size
    outline = svg.element("rect", width=width, height=height, fill="none", stroke=FAINT)
    if not is_numbered:
        return outline
    return outline + svg.group(*_across(frame), *_up(frame), font_size=_SIZE) + _scale_bar(frame)


def _across(frame: Frame) -> Iterator[str]:
    """Yield the ticks along x, below the panel."""
    bottom = frame.size[1]
    for value in frame.ticks(0):
        x, _ = frame.pixel((value, 0.0))
        yield svg.line((x, bottom), (x, bottom + 5), stroke=FAINT)
        yield _number(f"{value:g}", (x, bottom + 17), "middle")
    yield _number("x (m)", (0.0, bottom + 36), "start")


def _up(frame: Frame) -> Iterator[str]:
    """Yield the ticks along y, left of the panel."""
    for value in frame.ticks(1):
        _, y = frame.pixel((0.0, value))
        yield svg.line((-5.0, y), (0.0, y), stroke=FAINT)
        yield _number(f"{value:g}", (-8.0, y + 4), "end")
    yield _number("y (m)", (-8.0, -10.0), "end")


def _number(words: str, at: tuple[float, float], anchor: str) -> str:
    return svg.text(words, at, _SIZE, text_anchor=anchor, fill=FAINT)


def _scale_bar(frame: Frame) -> str:
    """Return a bar of a round length, below the panel at its right end."""
    length = round_length(70 / frame.scale)
    right, y = frame.size[0], frame.size[1] + 32
    left = right - length * frame.scale
    return svg.group(
        svg.line((left, y), (right, y)),
        svg.line((left, y - 4), (left, y + 4)),
        svg.line((right, y - 4), (right, y + 4)),
        svg.text(
            f"{length:g} m", (left - 8, y + 4), 12, text_anchor="end", fill=INK, stroke="none"
        ),
        stroke=INK,
        stroke_width=1.5,
    )
