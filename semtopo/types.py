"""Define the words that every room uses: kinds of space, occupancies, poses and options.

Plain immutable values; whatever exists is valid. The numbers behind `Kind` and `Occupancy` stand
in arrays of one byte each and in stored maps: they never change.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import IntEnum, StrEnum
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from semtopo.errors import InvalidOptionError, InvalidPoseError

Floats: TypeAlias = NDArray[np.float64]
Integers: TypeAlias = NDArray[np.intp]
Bytes: TypeAlias = NDArray[np.uint8]
Flags: TypeAlias = NDArray[np.bool_]
Complexes: TypeAlias = NDArray[np.complex128]
"""Points or directions, x + iy: a product with a conjugate is a dot and a cross product."""

Point: TypeAlias = tuple[float, float]
"""x and y in metres, map frame."""

SeenName: TypeAlias = tuple[str, int]
"""What names a zone in one scan: its label, and which of its parts, from 0 (R14)."""

NOWHERE = -1
"""The label index of a place that no zone covers."""


class Kind(IntEnum):
    """What a robot can do with a place: be in it, pass through it, be stopped by it."""

    SPACE = 0
    PASSAGE = 1
    OBSTACLE = 2
    UNKNOWN = 3  # R13: seen, but not labelled


class Occupancy(IntEnum):
    """Why a border point is where it is; where two claims meet, the greater one holds."""

    NONE = 0  # no border point at all
    FREE = 1
    PASSAGE = 2
    OBSTACLE = 3


class Edges(StrEnum):
    """Which pairs of zones are linked (R15)."""

    SEEN = "seen"
    ADJACENT = "adjacent"


class Passages(StrEnum):
    """How many passages from one zone to another the graph keeps (R10)."""

    FIRST = "first"
    ALL = "all"


class Identity(StrEnum):
    """What makes places one zone (R14): their label, or that they touch, too."""

    LABEL = "label"
    INSTANCE = "instance"


class Sensing(StrEnum):
    """How a simulated sensor looks: at samples, or at all that its beams cross (R16)."""

    SAMPLED = "sampled"
    EXACT = "exact"


@dataclass(frozen=True, slots=True)
class Pose:
    """Where a robot stands and looks: x, y in m, theta in rad, counter-clockwise from +x.

    Raises
    ------
    InvalidPoseError
        A coordinate is not finite.
    """

    x: float
    y: float
    theta: float = 0.0

    def __post_init__(self) -> None:
        """Refuse what is not finite."""
        if not all(map(math.isfinite, (self.x, self.y, self.theta))):
            raise InvalidPoseError("a pose needs finite x, y and theta")

    @property
    def position(self) -> Point:
        """The pose without its heading (p_r)."""
        return (self.x, self.y)


@dataclass(frozen=True, slots=True, kw_only=True)
class MappingOptions:
    """How a session maps; the defaults are the paper's behaviour.

    `edges` says which zones are linked (R15), `passages` how many passages lead from one to
    another (R10), `identity` what makes places one zone (R14); `sensing` how a simulated sensor
    looks (R16); `min_zone_area` in m^2 says below which size a zone of one scan is passed over
    (R9), `tolerance` in m how far a reduced border may lie from the unreduced one; at 0 it is not
    reduced (R17).

    Raises
    ------
    InvalidOptionError
        `min_zone_area` or `tolerance` is negative or not finite, or an option is none of its known
        words.
    """

    edges: Edges = Edges.SEEN
    passages: Passages = Passages.FIRST
    identity: Identity = Identity.LABEL
    sensing: Sensing = Sensing.SAMPLED
    min_zone_area: float = 0.0
    tolerance: float = 0.0

    def __post_init__(self) -> None:
        """Refuse values out of range, and turn words into their members."""
        for name, words in _CHOICES.items():
            if getattr(self, name) not in set(words):
                raise InvalidOptionError(f"{name} must be one of {', '.join(words)}")
            object.__setattr__(self, name, words(getattr(self, name)))
        for name, unit in (("min_zone_area", "m^2"), ("tolerance", "m")):
            if not (math.isfinite(getattr(self, name)) and getattr(self, name) >= 0):
                raise InvalidOptionError(f"{name} must be a finite number of {unit}, at least 0")


_CHOICES: dict[str, type[StrEnum]] = {
    "edges": Edges,
    "passages": Passages,
    "identity": Identity,
    "sensing": Sensing,
}
