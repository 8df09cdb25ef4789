"""Why there is no route: what can be reached, what could reach the goal, and what is between.

In come a network, an errand that cannot be done, and the map; out goes the refusal with what is
known of the gap. A frontier near the gap is where exploring may close it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from shapely import MultiLineString

from semtopo.borders import border_pieces
from semtopo.errand import Errand, Terms
from semtopo.errors.ways import MissingPassage, NearestFrontier, NoRouteError
from semtopo.mapper import MapState
from semtopo.network import Network
from semtopo.types import Occupancy, Point

ZONES_LOOKED_AT = 64
"""Zones whose frontiers are measured: those nearest to the gap."""


@dataclass(frozen=True, slots=True)
class Gap:
    """The zones, by number, that can be reached, and those from which a goal can be."""

    reachable: frozenset[int]
    reaching: frozenset[int]


def find_gap(network: Network, errand: Errand, terms: Terms) -> Gap | None:
    """Return the first gap on an errand, from stop to stop; None if every stop can be reached."""
    here = errand.start[0]
    is_open = not (terms.closed_zones or terms.closed_uses)
    linked = network.centre if is_open else frozenset[int]()
    for targets in [*([zone] for zone in errand.via), [zone for zone, _ in errand.goals]]:
        if here not in linked or linked.isdisjoint(targets):
            reachable = network.spread([here], terms)
            if reachable.isdisjoint(targets):
                return Gap(reachable, network.spread_back(targets, terms))
        here = targets[0]
    return None


def refusal(
    state: MapState, network: Network, gap: Gap, *, restricted: bool, two_way: bool
) -> NoRouteError:
    """Return what is to be said of a gap.

    It is `restricted` if there is none without restrictions, `two_way` if there is none with
    passages used against their direction.
    """
    names = list(network.zones)
    why = "while something on the way is closed or avoided" if restricted else "to the other"
    return NoRouteError(
        f"no passages lead from the one zone {why}",
        reachable=tuple(names[zone] for zone in sorted(gap.reachable)),
        reaching=tuple(names[zone] for zone in sorted(gap.reaching)),
        missing=_missing(network, gap),
        frontier=_frontier(state, network, gap),
        restricted=restricted,
        two_way=two_way,
    )


def _missing(network: Network, gap: Gap) -> MissingPassage | None:
    """Return the pair of zones across the gap that has been linked the wrong way for longest."""
    zones, pairs = network.zones, set(network.graph.pairs)
    for passage in network.graph.passages.values():
        pair = (passage.target, passage.source)
        across = zones[pair[0]] in gap.reachable and zones[pair[1]] in gap.reaching
        if across and pair not in pairs:
            return MissingPassage(*pair, since=passage.seq)
    return None


def _frontier(state: MapState, network: Network, gap: Gap) -> NearestFrontier | None:
    """Return the frontier of what can be reached that is nearest to what can reach the goal."""
    names, mapped = list(network.zones), state.metric.zones
    beyond = [mapped[names[zone]] for zone in sorted(gap.reaching)]
    tree = shapely.STRtree([zone.region for zone in beyond])
    near = [mapped[names[zone]] for zone in sorted(gap.reachable)]
    (own, _), apart = tree.query_nearest(
        [zone.region for zone in near], return_distance=True, all_matches=False
    )
    best: NearestFrontier | None = None
    for place in np.argsort(apart, kind="stable")[:ZONES_LOOKED_AT].tolist():
        if best is not None and apart[place] >= best.distance:
            break
        zone = near[own[place]]
        lines = [it.line for it in border_pieces(zone) if it.occupancy is Occupancy.FREE]
        if not lines:
            continue
        free = MultiLineString(lines)  # all at once: each alone is held against whole zones
        (to,), (distance,) = tree.query_nearest(free, return_distance=True, all_matches=False)
        if best is None or distance < best.distance:
            point = _nearest_on(free, beyond[to].region)
            best = NearestFrontier(zone.zone_id, point, beyond[to].zone_id, float(distance))
    return best


def _nearest_on(lines: MultiLineString, region: shapely.Geometry) -> Point:
    x, y = shapely.get_coordinates(shapely.shortest_line(lines, region))[0]
    return (float(x), float(y))
