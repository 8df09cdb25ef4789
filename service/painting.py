"""Paint an SVG as PNG; run as a module, from standard input to standard output.

The fonts come with a package, so that names are legible on a machine without any. Those of the
system are searched only for signs that ours lacks: that takes long where there are many.
"""

from __future__ import annotations

import re
import sys
from enum import StrEnum
from importlib import resources

import resvg_py

_FONT = "Roboto"
_FILES = ("Roboto-Regular.ttf", "Roboto-Bold.ttf")
_BEYOND = re.compile("[^\u0000-\u052f\u2000-\u22ff]")
"""Signs other than Latin, Greek, Cyrillic, punctuation, arrows and mathematics."""


class Form(StrEnum):
    """What a picture is written as."""

    SVG = "svg"
    PNG = "png"


def png_of(svg: str) -> bytes:
    """Return a picture as PNG, of the size in pixels that it names."""
    folder = resources.files("font_roboto") / "files"
    return resvg_py.svg_to_bytes(
        svg_string=svg,
        skip_system_fonts=_BEYOND.search(svg) is None,
        font_files=[str(folder / name) for name in _FILES],
        font_family=_FONT,
        sans_serif_family=_FONT,
    )


if __name__ == "__main__":
    sys.stdout.buffer.write(png_of(sys.stdin.buffer.read().decode()))
