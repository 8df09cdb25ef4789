"""The colours of a drawing: calm ones for zones, clear ones for what lies on their borders."""

from __future__ import annotations

import colorsys
from dataclasses import dataclass

from semtopo.types import Occupancy

INK = "#2b2f36"
FAINT = "#6b7280"
DIM = "#c9ced6"
"""The unexplored."""
PAPER = "#ffffff"
HALO = "#ffffff"
ROUTE = "#0b5fd9"
DOORWAY = "#e9ecf1"
FRONTIER = "#087f5b"
FONTS = "Helvetica, Arial, 'DejaVu Sans', sans-serif"
OCCUPANCY = {Occupancy.FREE: "#2f9e44", Occupancy.OBSTACLE: "#d6293a", Occupancy.PASSAGE: "#f2b705"}
"""As in the paper's figures; drawn in this order, so that passages stay visible."""

_GOLDEN = 0.381966  # of a full turn: neighbours in order are far apart, and none ever repeats
_FIRST = 0.58  # blue, for the zone found first


@dataclass(frozen=True, slots=True)
class Shade:
    """The colours of one zone: of its area, and of its outline and the edges that leave it."""

    area: str
    line: str


def shade(number: int) -> Shade:
    """Return the colours of the zone with this number, in the order of finding."""
    hue = (_FIRST + number * _GOLDEN) % 1.0
    lightness = (0.86, 0.80, 0.90)[number // 8 % 3]  # hues draw near each other after eight
    return Shade(_hex(hue, lightness, 0.62), _hex(hue, 0.36, 0.45))


def _hex(hue: float, lightness: float, saturation: float) -> str:
    red, green, blue = colorsys.hls_to_rgb(hue, lightness, saturation)
    return f"#{round(255 * red):02x}{round(255 * green):02x}{round(255 * blue):02x}"
