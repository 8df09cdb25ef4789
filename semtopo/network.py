"""The passages of a graph as a network: numbered, with what it costs at least from one to another.

In come a graph and a cost model; out goes what every search on that graph can share. Costs are
whole numbers, so that they add up exactly and equal ones are equal.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from semtopo.errand import OPEN, Terms
from semtopo.errors import InvalidOptionError
from semtopo.graph import Passage, TopologyGraph
from semtopo.types import Floats, Point

UNIT = 1e-6
"""The least difference in cost that counts: of a way in m, a micrometre."""

COST_MAX = 1e6

TURNS_MAX = 1_000_000
"""Pairs of a use that enters a zone and one that leaves it, in all zones; with more of them (a hall
of a thousand doors), they are not kept in memory."""

ENTRIES = 2**17
"""So many pairs of entering and leaving are tried in one zone: all, below 360 doors. A larger hall
is left from where it was first entered, the more doors it has the more so."""

POINTS_AIMED_AT = 16
"""With more points than this, how far the nearest one is would take longer to tell than to find;
how far their bounding box is, is told instead."""

ROUNDING = 1e-12
"""Relative; more than what distances and their sums may be off."""

NETWORKS_KEPT = 16
"""Networks in memory; one of 10,000 zones takes some 20 MB."""


@dataclass(frozen=True, slots=True)
class CostModel:
    """What a way costs: so much for each metre, and so much for each passage.

    Where length costs nothing, the shorter of two ways that cost the same still wins; and then the
    one with fewer passages.

    Raises
    ------
    InvalidOptionError
        A cost is not between 0 and a million.
    """

    length: float = 1.0
    passage: float = 0.0

    def __post_init__(self) -> None:
        """Refuse costs out of range."""
        if not all(0 <= cost <= COST_MAX for cost in (self.length, self.passage)):
            raise InvalidOptionError(f"a cost must be 0 to {COST_MAX:.0f}")

    def units(self, metres: float, passages: int) -> int:
        """Return the cost of so many metres and passages in whole units; a passage adds one."""
        cost = (self.length or UNIT) * metres + self.passage * passages
        return math.ceil(cost / UNIT) + passages


class Use(NamedTuple):
    """A passage, used from zone `source` into zone `target`: maybe against its direction."""

    passage: Passage
    source: int
    target: int


Row: TypeAlias = list[tuple[int, int, int]]
"""Uses that lead out of a zone, the zones they lead to, what it costs at least to go on by them."""


@dataclass(frozen=True, eq=False)
class Network:
    """The uses of all passages, numbered: first along, then, if `two_way`, against directions."""

    graph: TopologyGraph
    model: CostModel
    two_way: bool
    _rows: dict[int, Row] = field(default_factory=dict)

    @cached_property
    def zones(self) -> dict[str, int]:
        """The number of each zone."""
        return {zone_id: number for number, zone_id in enumerate(self.graph.nodes)}

    @cached_property
    def uses(self) -> tuple[Use, ...]:
        """Every way to use a passage, in order of finding."""
        passages = tuple(self.graph.passages.values())
        sources = [self.zones[passage.source] for passage in passages]
        targets = [self.zones[passage.target] for passage in passages]
        along = map(Use, passages, sources, targets)
        against = map(Use, passages, targets, sources) if self.two_way else ()
        return (*along, *against)

    @cached_property
    def leaving(self) -> list[list[int]]:
        """The uses that lead out of each zone."""
        return self._by_zone(use.source for use in self.uses)

    @cached_property
    def places(self) -> list[int]:
        """The place of each use among those that leave the same zone."""
        found = [0] * len(self.uses)
        for uses in self.leaving:
            for place, use in enumerate(uses):
                found[use] = place
        return found

    @cached_property
    def back(self) -> list[int]:
        """For each use that which leads back by the same point, if there is one, else -1."""
        ways = {(use.source, use.target, use.passage.point): it for it, use in enumerate(self.uses)}
        return [ways.get((use.target, use.source, use.passage.point), -1) for use in self.uses]

    @cached_property
    def entering(self) -> list[list[int]]:
        """The uses that lead into each zone."""
        return self._by_zone(use.target for use in self.uses)

    @cached_property
    def crowded(self) -> frozenset[int]:
        """The zones of so many doors that not all pairs of these are tried."""
        doors = zip(self.entering, self.leaving, strict=True)
        pairs = (len(entering) * len(leaving) for entering, leaving in doors)
        return frozenset(zone for zone, count in enumerate(pairs) if count > ENTRIES)

    @cached_property
    def turns(self) -> int:
        """How many pairs there are of a use and one that may follow it."""
        return sum(len(self.leaving[use.target]) for use in self.uses)

    @cached_property
    def points(self) -> Floats:
        """The passage points (uses, 2) in m, map frame."""
        return np.array([use.passage.point for use in self.uses]).reshape(-1, 2)

    @cached_property
    def centre(self) -> frozenset[int]:
        """Zones that can all reach each other: those linked so with the zone of most passages."""
        busiest = max(range(len(self.leaving)), key=lambda zone: len(self.leaving[zone]))
        return self.spread([busiest]) & self.spread_back([busiest])

    def spread(self, zones: Iterable[int], terms: Terms = OPEN) -> frozenset[int]:
        """Return the zones that can be reached from some, with these."""
        found, waiting, uses = set(zones), list(zones), self.uses
        closed_uses, closed_zones = terms.closed_uses, terms.closed_zones
        while waiting:
            for number in self.leaving[waiting.pop()]:
                zone = uses[number].target
                if zone not in found and number not in closed_uses and zone not in closed_zones:
                    found.add(zone)
                    waiting.append(zone)
        return frozenset(found)

    def spread_back(self, zones: Iterable[int], terms: Terms = OPEN) -> frozenset[int]:
        """Return the zones from which some can be reached, with these."""
        found, waiting, uses = set(zones), list(zones), self.uses
        while waiting:
            zone = waiting.pop()
            for number in () if zone in terms.closed_zones else self.entering[zone]:
                before = uses[number].source
                if before not in found and number not in terms.closed_uses:
                    found.add(before)
                    waiting.append(before)
        return frozenset(found)

    def row(self, use: int) -> Row:
        """Return the uses that may follow one, each with what the way to it costs at least."""
        known = self._rows.get(use)
        if known is None:
            here = self.uses[use]
            known = self.row_from(here.target, here.passage.point)
            if self.turns <= TURNS_MAX:
                self._rows[use] = known
        return known

    def row_from(self, zone: int, point: Point) -> Row:
        """Return the uses that lead out of a zone, each with its least cost from a point in it."""
        units, uses = self.model.units, self.uses
        return [
            (use, uses[use].target, units(math.dist(point, uses[use].passage.point), 1))
            for use in self.leaving[zone]
        ]

    def bounds(self, points: Sequence[Point], terms: Terms) -> memoryview:
        """Return what it costs at least from each use to the nearest of some points: straight."""
        if not points:
            return np.zeros(len(self.uses), np.int64).data
        ends, uses = np.array(points), self.points
        if len(points) <= POINTS_AIMED_AT:
            apart = uses[:, np.newaxis, :] - ends
            squares = (apart[..., 0] ** 2 + apart[..., 1] ** 2).min(axis=1)
        else:
            apart = np.maximum(0, np.maximum(ends.min(axis=0) - uses, uses - ends.max(axis=0)))
            squares = apart[..., 0] ** 2 + apart[..., 1] ** 2
        units = (self.model.length or UNIT) * terms.least_factor / UNIT
        bounds: NDArray[np.int64] = (np.sqrt(squares) * (units * (1 - ROUNDING))).astype(np.int64)
        return bounds.data

    def _by_zone(self, zones: Iterable[int]) -> list[list[int]]:
        found: list[list[int]] = [[] for _ in self.zones]
        for use, zone in enumerate(zones):
            found[zone].append(use)
        return found


@lru_cache(maxsize=NETWORKS_KEPT)
def network_of(graph: TopologyGraph, model: CostModel, two_way: bool) -> Network:  # noqa: FBT001 -- lru_cache tells keyword calls from others
    """Return the network of a graph; of the latest graphs, the same one again."""
    return Network(graph, model, two_way)
