"""Finds the routes of a request: the best, and others that are really different.

In come an atlas and a request; out go routes, one after the other as they are wanted.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from functools import lru_cache
from itertools import pairwise

from semtopo.atlas import Atlas
from semtopo.errand import OPEN, Errand, Stop, Terms, Way
from semtopo.gap import find_gap, refusal
from semtopo.ground import ground_of
from semtopo.journey import Place, Route, RouteRequest
from semtopo.metric import MetricMap
from semtopo.network import NETWORKS_KEPT, Network, network_of
from semtopo.search import Search, Turns, Ways
from semtopo.types import Point

SHARED_MAX = 0.7
"""How much of its length a route may share with a better one, and still be another."""

DEARER = 1.5
"""So many times more a passage costs for each earlier route that used it."""

SEARCHES_MAX = 40
"""Searches for one request; a map may have no more routes that are different enough."""

LOOKED_AT_MAX = 200_000
"""After so many uses of passages were looked at, about 1 s, no further alternative is searched."""


class Finder:
    """Finds the routes of one request."""

    def __init__(self, atlas: Atlas, request: RouteRequest) -> None:
        """Turn the names of the request into numbers of its network."""
        self._atlas, self._request = atlas, request
        self._state, self._metric, self._cost = atlas.state, atlas.state.metric, request.cost
        self._network = network_of(atlas.state.graph, request.cost, request.two_way)
        self._names = list(self._network.zones)
        number = self._network.zones
        self._errand = Errand(
            self._stop(request.start),
            [self._stop(goal) for goal in request.goals],
            [number[zone_id] for zone_id in request.via],
        )
        self._terms = terms_of(atlas, request, self._network)
        self._ways = Ways(self._length, _turns(self._network, self._metric))

    def routes(self) -> Iterator[Route]:
        """Yield the best route, then others that are different enough; raises NoRouteError."""
        gap = find_gap(self._network, self._errand, self._terms)
        if gap is not None:
            is_free = find_gap(self._network, self._errand, OPEN) is None
            raise refusal(
                self._state, self._network, gap, restricted=is_free, two_way=self._is_two_way()
            )
        used: Counter[int] = Counter()
        found: list[Route] = []
        looked_at = searches = 0
        while searches < SEARCHES_MAX and looked_at < LOOKED_AT_MAX:
            way = Search(self._network, self._ways, self._errand, self._dearer(used)).run()
            if way is None:
                return
            searches, looked_at = searches + 1, looked_at + way.looked_at
            route = self._route(way)
            if all(self._shared(route, other) <= SHARED_MAX for other in found):
                found.append(route)
                yield route
            if not way.uses:
                return
            used.update(way.uses)

    def _is_two_way(self) -> bool:
        """Say whether there is a route with passages used against their direction, if only so."""
        if self._network.two_way:
            return False
        both = network_of(self._state.graph, self._cost, True)  # noqa: FBT003 -- as in network_of
        return find_gap(both, self._errand, terms_of(self._atlas, self._request, both)) is None

    def _dearer(self, used: Counter[int]) -> Terms:
        """Return the terms on which what was used costs more."""
        if not used:
            return self._terms
        factors = dict(self._terms.use_factors)
        for use, times in used.items():
            factors[use] = factors.get(use, 1.0) * DEARER**times
        return replace(self._terms, use_factors=factors)

    def _stop(self, place: Place) -> Stop:
        point = place.point or ground_of(self._metric, place.zone_id).widest_place
        return (self._network.zones[place.zone_id], point)

    def _length(self, zone: int, start: Point, end: Point) -> float:
        """Return the length in m of the way inside a zone."""
        return ground_of(self._metric, self._names[zone]).length(start, end)

    def _shared(self, one: Route, other: Route) -> float:
        """Return how much of the shorter of two routes is the same in both, from 0 to 1."""
        legs = [set(zip(it.zones, pairwise(it.points), strict=True)) for it in (one, other)]
        if legs[0] == legs[1]:
            return 1.0
        zones = self._network.zones
        same = math.fsum(self._length(zones[zone], *ends) for zone, ends in legs[0] & legs[1])
        return same / min(one.length, other.length) if same else 0.0

    def _route(self, way: Way) -> Route:
        uses = [self._network.uses[number] for number in way.uses]
        start, goal = self._errand.start, self._errand.goals[way.goal]
        zones = [start[0], *(use.target for use in uses)]
        points = (start[1], *(use.passage.point for use in uses), goal[1])
        legs = zip(zones, pairwise(points), strict=True)
        lengths = [self._length(zone, *ends) for zone, ends in legs]
        tolls = [*([self._cost.passage] * len(uses)), 0.0]
        factors = map(self._terms.factor, zones, (*way.uses, -1))
        costs = [
            (self._cost.length * length + toll) * factor
            for length, toll, factor in zip(lengths, tolls, factors, strict=True)
        ]
        return Route(
            tuple(self._names[zone] for zone in zones),
            tuple(use.passage for use in uses),
            points,
            math.fsum(costs),
            math.fsum(lengths),
        )


@lru_cache(maxsize=NETWORKS_KEPT)
def _turns(_network: Network, _metric: MetricMap) -> dict[int, Turns]:
    """Return where the costs of turns of a network on a map are kept; of the latest, the same."""
    return {}


def terms_of(atlas: Atlas, request: RouteRequest, network: Network) -> Terms:
    """Return the terms of a request: what restrictions of the atlas, and it, close or make dear."""
    limits, zones = atlas.limits, network.zones
    closed = limits.closed_passages | request.avoid_passages
    priced = limits.passage_factors
    keys = [use.passage.key for use in network.uses] if closed or priced else []
    return Terms(
        frozenset(zones[it] for it in limits.closed_zones | request.avoid_zones if it in zones),
        frozenset(use for use, key in enumerate(keys) if key in closed),
        {zones[it]: factor for it, factor in limits.zone_factors.items() if it in zones},
        {use: priced[key] for use, key in enumerate(keys) if key in priced},
    )
