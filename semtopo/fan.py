"""A fan of beams: where they point, and how they follow one another."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from semtopo.geometry import as_complex
from semtopo.types import Complexes, Floats, Integers

HALF_TURN = 3.1
"""rad; beams farther apart than that enclose no ground that lies between them."""

SAME_DIRECTION = 1e-5
"""rad; so near to each other, the first and the last beam of a scan may overlap."""


class Beams(NamedTuple):
    """Beams counter-clockwise, (beams,) each: where they point, and how they follow one another.

    `along` are their directions, `bearings` how far they are turned from the first, in rad, `after`
    which of them follows each, the first after the last, and `widths` the sines of the angles
    between them and the beams of the fan that follow.
    """

    along: Complexes
    bearings: Floats
    after: Integers
    widths: Floats

    @classmethod
    def of(cls, fan: Fan, beams: Integers) -> Beams:
        """Put together what is known of some beams that follow one another."""
        bearings = fan.bearings[beams]
        bearings -= bearings[0]
        bearings += (2 * math.pi) * (bearings < 0)
        after = np.arange(1, len(beams) + 1)
        after[-1] = 0
        widths = fan.widths[beams[after] if fan.clockwise else beams]
        return cls(fan.along[beams], bearings, after, widths)


@dataclass(frozen=True, eq=False)
class Fan:
    """The beams of a scan, in order of bearing: `directions` (beams, 2) are unit vectors.

    `ring` says whether the last beam is a neighbour of the first. What follows from the directions
    is computed once, and a sensor keeps its fan from step to step.
    """

    directions: Floats
    ring: bool

    def __len__(self) -> int:
        """Return how many beams there are."""
        return len(self.directions)

    @cached_property
    def along(self) -> Complexes:
        """The directions as complex numbers, (beams,)."""
        return as_complex(self.directions)

    @cached_property
    def following(self) -> Integers:
        """Which beam comes after each, (beams,); the first after the last."""
        return np.roll(np.arange(len(self)), -1)

    @cached_property
    def bearings(self) -> Floats:
        """The directions in rad, counter-clockwise from +x, (beams,)."""
        return np.angle(self.along)

    @cached_property
    def turns(self) -> Floats:
        """By how much the beam after each is turned from it, in rad, (beams,)."""
        return np.angle(self.along.conj() * np.roll(self.along, -1))

    @cached_property
    def widths(self) -> Floats:
        """The sine of the angle between each beam and the next, (beams,)."""
        return np.abs((self.along.conj() * np.roll(self.along, -1)).imag)

    @cached_property
    def around(self) -> Beams:
        """All beams of a ring, counter-clockwise, from the first that is last if clockwise."""
        return Beams.of(self, np.arange(len(self))[:: -1 if self.clockwise else 1])

    @cached_property
    def clockwise(self) -> bool:
        """Whether the beams follow one another clockwise."""
        return len(self) > 1 and bool(self.turns[0] < 0)

    @cached_property
    def is_even(self) -> bool:
        """Whether all beams turn the same way, from one to the next by less than half a turn."""
        turns = np.abs(self.turns) if self.ring else np.abs(self.turns[:-1])
        same = (self.turns[: len(turns)] < 0) == self.clockwise
        return bool((same & (turns < HALF_TURN)).all())

    @cached_property
    def overlaps(self) -> bool:
        """Whether the last beam, without being a neighbour of the first, looks along it."""
        ends = self.directions[[0, -1]]
        return not self.ring and float(np.abs(ends[0] - ends[1]).max()) <= SAME_DIRECTION
