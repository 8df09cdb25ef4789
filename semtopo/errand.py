"""What a search through a network is asked, and what it finds: all by the numbers of the network.

Plain values, so that the search is all that there is in its own room.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TypeAlias

from semtopo.types import Point

Stop: TypeAlias = tuple[int, Point]
"""A zone, by its number, and a point in it."""


@dataclass(frozen=True, slots=True)
class Terms:
    """What is closed to a search, and the factors of what costs more or less, by number."""

    closed_zones: Collection[int] = frozenset()
    closed_uses: Collection[int] = frozenset()
    zone_factors: Mapping[int, float] = field(default_factory=dict)
    use_factors: Mapping[int, float] = field(default_factory=dict)

    @property
    def least_factor(self) -> float:
        """No way costs less than this times what it costs without factors; at most 1."""
        zones, uses = self.zone_factors.values(), self.use_factors.values()
        return min((1.0, *zones)) * min((1.0, *uses))

    def factor(self, zone: int, use: int) -> float:
        """Return the factor of a way inside a zone to a use that leads out of it."""
        return self.zone_factors.get(zone, 1.0) * self.use_factors.get(use, 1.0)


OPEN = Terms()
"""Nothing is closed, nor dearer."""


@dataclass(frozen=True, slots=True)
class Errand:
    """From where to which goals, and which zones must be visited before, in order."""

    start: Stop
    goals: Sequence[Stop]
    via: Sequence[int] = ()


@dataclass(frozen=True, slots=True)
class Way:
    """The uses in order, which of the goals is reached, and how many uses were looked at."""

    uses: tuple[int, ...]
    goal: int
    looked_at: int
