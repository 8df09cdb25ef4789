"""Write SVG as text: elements, numbers and foreign words, and nothing about maps."""

from __future__ import annotations

import re
from itertools import groupby
from xml.sax.saxutils import escape, quoteattr

from semtopo.types import Floats, Point

_FORBIDDEN = re.compile("[^\t\n\r\u0020-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""What XML 1.0 cannot hold at all (section 2.2, Char)."""

_WIDE = 0x1100  # from here on, scripts mostly have signs as wide as they are high


def element(tag: str, *children: str, **attributes: str | float) -> str:
    """Return an element; `_` in an attribute's name stands for `-`, children are SVG already."""
    words = [f"{name.replace('_', '-')}={_value(value)}" for name, value in attributes.items()]
    head = " ".join([tag, *words])
    return f"<{head}>{''.join(children)}</{tag}>" if children else f"<{head}/>"


def text(words: str, at: Point, size: float, **attributes: str | float) -> str:
    """Return one line of text; it starts, or as `text_anchor` says, at a point of its baseline."""
    return element("text", characters(words), x=at[0], y=at[1], font_size=size, **attributes)


def title(words: str) -> str:
    """Return what a viewer shows on hovering."""
    return element("title", characters(words))


def group(*children: str, **attributes: str | float) -> str:
    """Return elements that share attributes."""
    return element("g", *children, **attributes)


def line(start: Point, end: Point, **attributes: str | float) -> str:
    """Return a straight line."""
    return element("line", x1=start[0], y1=start[1], x2=end[0], y2=end[1], **attributes)


def characters(words: str) -> str:
    """Return any text as XML character data; what XML cannot hold becomes U+FFFD."""
    return escape(_FORBIDDEN.sub("\ufffd", words))


def number(value: float) -> str:
    """Return a number in tenths, as short as can be: a pixel is never cut finer."""
    return f"{round(value, 1) + 0.0:.1f}".removesuffix(".0")  # + 0.0 makes -0.0 a 0.0


def points(xy: Floats) -> str:
    """Return (n, 2) points as `x,y x,y ...`, without repetitions of what looks the same."""
    return " ".join(word for word, _ in groupby(f"{number(x)},{number(y)}" for x, y in xy))


def dots(xy: Floats) -> str:
    """Return path data that puts a round pen down at each of (n, 2) points."""
    return "".join(f"M{number(x)} {number(y)}h0" for x, y in xy)


def text_width(words: str) -> float:
    """Return about how wide a text is, as a multiple of its font size."""
    return sum(1.0 if ord(sign) >= _WIDE else 0.58 for sign in words)


def shortened(words: str, length: int) -> str:
    """Return a text of at most so many signs, with an ellipsis where it was cut."""
    return words if len(words) <= length else words[: length - 1] + "\u2026"


def _value(value: str | float) -> str:
    """Return the value of an attribute, in quotes."""
    return quoteattr(_FORBIDDEN.sub("\ufffd", value) if isinstance(value, str) else number(value))
