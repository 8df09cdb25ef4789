"""The search in stages, where most ways cost the same: held against all ways between any two uses.

On a grid of rooms with a door in the middle of each wall nearly every way has equals, and straight
ahead is never how one goes. There the order in which ways are tried tells most.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import pairwise

import networkx as nx
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from semtopo import finder, search
from semtopo.atlas import Atlas
from semtopo.errors.ways import NoRouteError
from semtopo.journey import Place, RouteRequest
from semtopo.network import CostModel
from semtopo.notes import Restriction, ZoneRef
from semtopo.route import find_routes
from semtopo.types import Point
from tests.atlases import Edge, atlas
from tests.strategies import many

Cell = tuple[int, int]

DEAR = 3.0


@dataclass(frozen=True)
class Tour:
    """Cells of a grid to begin in, to go through in order, and to end in."""

    atlas: Atlas
    start: Cell
    via: tuple[Cell, ...]
    goal: Cell
    cost: CostModel

    @property
    def request(self) -> RouteRequest:
        """The same, asked of the atlas."""
        via = tuple(map(name, self.via))
        goals = (Place(name(self.goal), middle(self.goal)),)
        start = Place(name(self.start), middle(self.start))
        return RouteRequest(start=start, goals=goals, via=via, cost=self.cost)


def name(cell: Cell) -> str:
    return f"{cell[0]}-{cell[1]}"


def middle(cell: Cell) -> Point:
    return (cell[0] + 0.5, cell[1] + 0.5)


def doors(width: int, height: int) -> list[Edge]:
    """Return all doors of a grid, each in both directions."""
    found: list[Edge] = []
    for x in range(width):
        for y in range(height):
            for dx, dy in ((1, 0), (0, 1)):
                if x + dx < width and y + dy < height:
                    ends = name((x, y)), name((x + dx, y + dy))
                    point = (x + 0.5 + dx / 2, y + 0.5 + dy / 2)
                    found += [(*ends, point), (*ends[::-1], point)]
    return found


@st.composite
def tours(draw: st.DrawFn) -> Tour:
    """Draw a grid of 4 to 36 rooms without some doors, and up to four rooms to go through."""
    width, height = draw(st.integers(2, 6)), draw(st.integers(2, 6))
    every = doors(width, height)
    shut = draw(st.sets(st.integers(0, len(every) - 1), max_size=6))
    cells = st.tuples(st.integers(0, width - 1), st.integers(0, height - 1))
    costly = draw(st.none() | cells)
    limits = () if costly is None else (Restriction("r", ZoneRef(name(costly)), factor=DEAR),)
    made = atlas(
        [edge for number, edge in enumerate(every) if number not in shut],
        {
            name((x, y)): shapely.box(x, y, x + 1, y + 1)
            for x in range(width) for y in range(height)
        },
        restrictions=limits,
    )  # fmt: skip
    via = tuple(draw(st.lists(cells, max_size=4)))
    model = draw(st.sampled_from([CostModel(), CostModel(0.0, 1.0), CostModel(1.0, 0.5)]))
    return Tour(made, draw(cells), via, draw(cells), model)


def least_cost(tour: Tour) -> float:
    """Return what the best way costs: of all ways from where a room is entered to the next room.

    Between two rooms to visit one may go by any passages, also through a room on the list.
    """
    uses = list(tour.atlas.state.graph.passages.values())
    between = dict(nx.all_pairs_dijkstra_path_length(turns_of(tour)))
    zone, arrivals = name(tour.start), [(0.0, middle(tour.start))]
    for cell in without_repeats(tour):
        before, zone = zone, name(cell)
        arrivals = [
            (least, use.point)
            for number, use in enumerate(uses)
            if use.target == zone
            and math.isfinite(least := cost_to(number, before, arrivals, tour, between))
        ]
    goal = name(tour.goal)
    ends = [(paid, point) for paid, point in arrivals if zone == goal]
    ends += [
        (cost_to(number, zone, arrivals, tour, between), use.point)
        for number, use in enumerate(uses)
        if use.target == goal
    ]
    costs = [paid + leg_cost(tour, goal, point, middle(tour.goal), 0) for paid, point in ends]
    return min(costs, default=math.inf)


def cost_to(
    use: int, zone: str, arrivals: list[tuple[float, Point]], tour: Tour,
    between: dict[int, dict[int, float]],
) -> float:  # fmt: skip
    """Return the least cost to be at the end of a use, from where one arrived in a zone."""
    first = [
        (number, passage.point)
        for number, passage in enumerate(tour.atlas.state.graph.passages.values())
        if passage.source == zone
    ]
    costs = (
        paid + leg_cost(tour, zone, at, point, 1) + between[number].get(use, math.inf)
        for paid, at in arrivals for number, point in first
    )  # fmt: skip
    return min(costs, default=math.inf)


def turns_of(tour: Tour) -> nx.DiGraph[int]:
    """Return which passage may follow which, and for how much."""
    uses = list(tour.atlas.state.graph.passages.values())
    turns: nx.DiGraph[int] = nx.DiGraph()
    turns.add_nodes_from(range(len(uses)))
    turns.add_weighted_edges_from(
        (one, other, leg_cost(tour, use.target, use.point, uses[other].point, 1))
        for one, use in enumerate(uses)
        for other in range(len(uses)) if uses[other].source == use.target
    )  # fmt: skip
    return turns


def leg_cost(tour: Tour, zone: str, start: Point, end: Point, passages: int) -> float:
    """Return what it costs to go inside a room, and through a door if one ends the way."""
    metres = tour.cost.length * math.dist(start, end)
    dear = any(it.on == ZoneRef(zone) for it in tour.atlas.restrictions)
    return (metres + tour.cost.passage * passages) * (DEAR if dear else 1.0)


@settings(max_examples=120)
@given(tour=tours())
def test_a_tour_is_the_best_of_all(tour: Tour) -> None:
    least = least_cost(tour)
    if math.isinf(least):
        with pytest.raises(NoRouteError):
            find_routes(tour.atlas, tour.request)
        return
    route = find_routes(tour.atlas, tour.request)[0]
    assert route.cost == pytest.approx(least, abs=1e-3)
    visits = iter(route.zones)
    assert all(name(cell) in visits for cell in without_repeats(tour))


def without_repeats(tour: Tour) -> list[Cell]:
    """Return the rooms to visit; one that comes twice in a row is visited once."""
    stops = [tour.start, *tour.via]
    return [after for before, after in pairwise(stops) if after != before]


def test_tours_are_not_vacuous() -> None:
    """Most tours exist and are long; some do not, and some come back to where they were."""
    seen = dict.fromkeys(["all", "none", "long", "returning", "tied"], 0)

    @many
    @given(tour=tours())
    def look(tour: Tour) -> None:
        seen["all"] += 1
        try:
            route = find_routes(tour.atlas, tour.request)[0]
        except NoRouteError:
            seen["none"] += 1
            return
        seen["long"] += len(route.passages) > 8
        seen["returning"] += len(set(route.zones)) < len(route.zones)
        turned = {zone[0] for zone in route.zones}, {zone[-1] for zone in route.zones}
        seen["tied"] += min(map(len, turned)) > 2

    look()
    assert seen["none"] > 0
    assert min(seen["long"], seen["returning"], seen["tied"]) > seen["all"] / 8, seen


def test_alternatives_are_not_looked_for_without_end(monkeypatch: pytest.MonkeyPatch) -> None:
    """On large maps fewer searches are made; the best way is found however large the map is."""
    place = atlas(doors(9, 9), {
        name((x, y)): shapely.box(x, y, x + 1, y + 1) for x in range(9) for y in range(9)
    })  # fmt: skip
    tour = Tour(place, (0, 0), (), (8, 4), CostModel())
    request = replace(tour.request, alternatives=4)
    routes = find_routes(place, request)
    assert len(routes) == 4
    monkeypatch.setattr(finder, "LOOKED_AT_MAX", 1)
    assert find_routes(place, request) == routes[:1]


@many
@given(tour=tours())
def test_a_network_too_large_to_keep_its_turns_has_the_same_routes(tour: Tour) -> None:
    try:
        kept = find_routes(tour.atlas, tour.request)
    except NoRouteError:
        return
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(search, "TURNS_MAX", 0)
        patch.setattr(finder, "_turns", lambda *_: {})
        assert find_routes(tour.atlas, tour.request) == kept
