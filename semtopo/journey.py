"""What a route is, and what is asked when one asks for routes.

Plain values, which the search fills and everybody reads.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from semtopo.errors import InvalidOptionError
from semtopo.freespace import Path
from semtopo.graph import Passage, PassageKey
from semtopo.network import CostModel
from semtopo.types import Point

STOPS_MAX = 20
"""Zones to go through, of one request; each is a search of its own."""

ALTERNATIVES_MAX = 10

RADIUS_MAX = 100.0
"""m"""


@dataclass(frozen=True, slots=True)
class Place:
    """A zone, or a point in it in m, map frame; a zone alone stands for its widest place."""

    zone_id: str
    point: Point | None = None


@dataclass(frozen=True, slots=True)
class WayOptions:
    """How a robot goes: its `radius` in m, if it wants paths, and if passages are open both ways.

    Raises
    ------
    InvalidOptionError
        The radius is not between 0 and `RADIUS_MAX`.
    """

    radius: float | None = None
    two_way: bool = False

    def __post_init__(self) -> None:
        """Refuse a radius out of range."""
        if self.radius is not None and not 0 <= self.radius <= RADIUS_MAX:
            raise InvalidOptionError(f"radius must be 0 to {RADIUS_MAX:.0f} m")


ANY_WAY = WayOptions()
"""Of a robot without extent that uses passages along their direction."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RouteRequest:
    """Asks for routes from a place to the nearest of some goals.

    They go through the zones `via` in that order, enter no zone of `avoid_zones` and use no passage
    of `avoid_passages`. With `two_way`, passages may be used against their direction. With a
    `radius`, that of the robot in m, each comes with a dense path. `alternatives` says how many
    routes are wanted, at most.

    Raises
    ------
    InvalidOptionError
        There is no goal, or there are too many goals, zones to go through, or alternatives; or the
        radius is not between 0 and `RADIUS_MAX`.
    """

    start: Place
    goals: tuple[Place, ...]
    via: tuple[str, ...] = ()
    avoid_zones: frozenset[str] = frozenset()
    avoid_passages: frozenset[PassageKey] = frozenset()
    two_way: bool = False
    cost: CostModel = field(default_factory=CostModel)
    radius: float | None = None
    alternatives: int = 1

    def __post_init__(self) -> None:
        """Refuse what is too much."""
        if not self.goals:
            raise InvalidOptionError("a route needs a goal")
        if len(self.via) > STOPS_MAX:
            raise InvalidOptionError(f"a route goes through at most {STOPS_MAX} given zones")
        if not 1 <= self.alternatives <= ALTERNATIVES_MAX:
            raise InvalidOptionError(f"alternatives must be 1 to {ALTERNATIVES_MAX}")
        if self.radius is not None and not 0 <= self.radius <= RADIUS_MAX:
            raise InvalidOptionError(f"radius must be 0 to {RADIUS_MAX:.0f} m")

    @property
    def named(self) -> Iterator[str]:
        """Every zone that must be there."""
        yield self.start.zone_id
        yield from (goal.zone_id for goal in self.goals)
        yield from self.via


@dataclass(frozen=True, slots=True)
class Route:
    """A way through `zones` by `passages`: one zone more than passages, all in order.

    `points` are the start, the passage points and the goal, in m, map frame. `length` in m is that
    of the way between them inside the zones, and `cost` what the cost model and restrictions make
    of it. The `path`, if one was asked for, need not touch the passage points.
    """

    zones: tuple[str, ...]
    passages: tuple[Passage, ...]
    points: tuple[Point, ...]
    cost: float
    length: float
    path: Path | None = None

    @property
    def source(self) -> str:
        """The zone in which it begins."""
        return self.zones[0]

    @property
    def target(self) -> str:
        """The zone in which it ends."""
        return self.zones[-1]

    @property
    def backwards(self) -> tuple[Passage, ...]:
        """The passages that are used against their direction, in order."""
        uses = zip(self.zones, self.passages, strict=False)
        return tuple(passage for zone_id, passage in uses if passage.source != zone_id)
