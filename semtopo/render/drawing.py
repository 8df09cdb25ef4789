"""What a picture is to show: layers, size, and what there is besides the map itself."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

from semtopo.errors import InvalidOptionError
from semtopo.graph import PassageKey
from semtopo.types import Point

SIDE_MIN, SIDE_MAX = 240, 4096
"""Pixels; below, headings and axes are all that fits; 4096 squared are 64 MiB once painted."""

TRAIL_MAX = 1_000
"""Positions of a trail: more would not show, and the picture stays below a megabyte."""


class Layer(StrEnum):
    """What a picture may show; drawn in this order."""

    DOORWAYS = "doorways"
    ZONES = "zones"
    FRONTIERS = "frontiers"
    BORDERS = "borders"
    TRAIL = "trail"
    PASSAGES = "passages"
    ROBOT = "robot"
    LABELS = "labels"
    AXES = "axes"
    GRAPH = "graph"
    LEGEND = "legend"


ALL_LAYERS = frozenset(Layer)
DEFAULT_LAYERS = ALL_LAYERS - {Layer.FRONTIERS}
"""As in the paper's figure 3: there, border points alone say where the unknown begins."""


@dataclass(frozen=True, slots=True)
class DrawnRoute:
    """A route on the map: its line in m, map frame, and the passages that it takes."""

    line: tuple[Point, ...]
    passages: frozenset[PassageKey]


@dataclass(frozen=True, slots=True, kw_only=True)
class Drawing:
    """How to draw a map.

    `trail` is where the robot was, in m, map frame, oldest first; it stands at the end. A picture
    of which neither `width` nor `height` in pixels is given is as large as its map needs, and if
    one is given, the other follows. `caption` stands below the map. The points `around` in m lie
    on the picture too, so that several pictures may show the same stretch of the world.

    Raises
    ------
    InvalidOptionError
        A side is shorter than `SIDE_MIN` or longer than `SIDE_MAX`.
    """

    trail: Sequence[Point] = ()
    layers: frozenset[Layer] = DEFAULT_LAYERS
    width: int | None = None
    height: int | None = None
    route: DrawnRoute | None = None
    caption: str = ""
    around: Sequence[Point] = ()

    def __post_init__(self) -> None:
        """Refuse sizes out of range."""
        for side in (self.width, self.height):
            if side is not None and not SIDE_MIN <= side <= SIDE_MAX:
                raise InvalidOptionError(f"a picture has {SIDE_MIN} to {SIDE_MAX} pixels a side")

    def shows(self, layer: Layer) -> bool:
        """Say whether a layer is to be seen."""
        return layer in self.layers


def read_layers(words: str) -> frozenset[Layer]:
    """Return the layers of a list of names with commas between.

    Raises
    ------
    InvalidOptionError
        A name is none of a layer.
    """
    names = words.split(",")
    if not set(names) <= set(Layer):
        raise InvalidOptionError(f"layers are some of {', '.join(Layer)}, with commas between")
    return frozenset(map(Layer, names))


def trail_stride(seq: int) -> int:
    """Return of how many steps one is shown, so that a trail of `seq` steps is not too long."""
    return max(1, -(-seq // TRAIL_MAX))


def thinned_trail(positions: Sequence[Point]) -> list[Point]:
    """Return the positions of steps 1, 2, ... thinned by `trail_stride`; the last one stays."""
    stride, last = trail_stride(len(positions)), len(positions)
    return [at for seq, at in enumerate(positions, start=1) if seq % stride == 0 or seq == last]
