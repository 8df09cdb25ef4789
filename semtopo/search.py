"""The search for the best way through a network: A* on uses of passages (Hart et al., 1968).

In come a network, where to go and on what terms; out goes the sequence of uses that costs least.
The way inside a zone is first taken as straight; its true length is asked for only when the search
is about to follow it (lazily, as Cohen et al., 2014, do). From zone to zone that must be visited
the search goes in stages: what comes after a zone depends only on how it was entered.
"""

from __future__ import annotations

import heapq
import math
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import TypeAlias

from semtopo.errand import OPEN, Errand, Terms, Way
from semtopo.network import ENTRIES, TURNS_MAX, Network
from semtopo.types import Point

Legs: TypeAlias = Callable[[int, Point, Point], float]
"""Gives the length in m of the way inside a zone, by its number, between two points."""


Turns: TypeAlias = list[tuple[int, int, int, bool]]
"""Uses that may follow one, the zones they lead to, what it costs at least to go on by them, and
whether it is known to cost just that. They stand in the order in which the network has them."""


@dataclass(frozen=True, slots=True)
class Ways:
    """The ways inside the zones of a map, and what is known of the turns of a network, by use."""

    legs: Legs
    turns: dict[int, Turns]


_Item: TypeAlias = tuple[int, int, int, int, int]
"""Least cost in all, cost so far (negative: of equal ones, the farther goes first), state, the
state before it, and the true cost there; or EXACT, where the cost so far is true."""

EXACT = -1


class Search:
    """One search, in stages: to each zone of `via` in turn, then to a goal.

    A state is a use, or a goal, together with how many zones of `via` lie behind. A stage begins
    at all uses that may enter the zone where the one before it ended, each with its own cost.
    """

    def __init__(self, network: Network, ways: Ways, errand: Errand, terms: Terms) -> None:
        """Give the goals numbers, and leave out of `via` where one is already."""
        self._network, self._errand, self._terms = network, errand, terms
        self._legs, self._turns, self._places = ways.legs, ways.turns, network.places
        self._apply = terms != OPEN
        self._count = len(network.uses)
        self._stride = self._count + len(errand.goals)
        self._via = [zone for zone, _ in groupby((errand.start[0], *errand.via))][1:]
        self._ends: dict[int, list[int]] = {}
        for number, (zone, _) in enumerate(errand.goals, start=self._count):
            self._ends.setdefault(zone, []).append(number)
        self._bounds = memoryview(b"")
        self._before: dict[int, int] = {}
        self._waiting: list[_Item] = []

    def run(self) -> Way | None:
        """Return the way that costs least; of several, always the same one."""
        entries: list[_Item] = []
        for layer, zone in enumerate(self._via):
            targets = [use for use in self._network.entering[zone] if not self._is_closed(use)]
            points = [self._network.uses[use].passage.point for use in targets]
            self._begin(layer, points, entries)
            entries = self._stage(layer, len(targets))
        self._begin(len(self._via), [point for _, point in self._errand.goals], entries)
        for _, _, state, before, _ in self._stage(len(self._via), 1):
            uses = self._uses_until(before)
            return Way(uses, state % self._stride - self._count, len(self._before))
        return None

    def _begin(self, layer: int, points: Sequence[Point], entries: Sequence[_Item]) -> None:
        """Let where a stage begins wait; the stage leads to the nearest of some points."""
        self._bounds = self._network.bounds(points, self._terms)
        self._waiting = []
        if layer == 0:
            start, point = self._errand.start
            turns = [(*turn, False) for turn in self._network.row_from(start, point)]
            self._follower(layer)(-1, 0, start, turns)
        for _, cost, state, before, paid in entries:
            bound = self._bounds[state % self._stride]
            heapq.heappush(self._waiting, (bound - cost, cost, state, before, paid))

    def _stage(self, layer: int, wanted: int) -> list[_Item]:
        """Return what is reached at the end of a stage, as far as it can matter, cheapest first."""
        known, waiting, entered = self._before, self._waiting, Counter[int]()
        uses, stride, count = self._network.uses, self._stride, self._count
        pop, follow, crowded = heapq.heappop, self._follower(layer), self._network.crowded
        found: dict[int, _Item] = {}
        limit, end = math.inf, (layer + 1) * stride
        while waiting and len(found) < wanted:
            bound, cost, state, before, paid = pop(waiting)
            if bound >= limit:
                break
            if state in known or state in found:
                continue
            if paid != EXACT and self._is_dearer(bound, cost, state, before, paid):
                continue
            number = state % stride
            if state >= end or number >= count:
                found[state] = (bound, cost, state, before, EXACT)
                if len(found) == 1 < wanted:
                    limit = self._detour(layer + 1, number) - cost
                continue
            known[state] = before
            zone = uses[number].target
            if zone not in crowded or self._is_tried(zone, entered):
                follow(state, -cost, zone, self._turns_of(number))
        return list(found.values())

    def _is_tried(self, zone: int, entered: Counter[int]) -> bool:
        """Say whether a crowded zone is left from where it is entered now, for the nth time."""
        entered[zone] += 1
        return entered[zone] == 1 or entered[zone] * len(self._network.leaving[zone]) <= ENTRIES

    def _is_dearer(self, bound: int, cost: int, state: int, before: int, paid: int) -> bool:
        """Let a state wait again if it costs more, on the true way to it, than was thought."""
        true = paid + self._true_cost(before, state)
        if true > -cost:
            heapq.heappush(self._waiting, (bound + true + cost, -true, state, before, EXACT))
        return true > -cost

    def _detour(self, layer: int, use: int) -> int:
        """Return how much dearer it is at most to go on from a use than from any other beside it.

        Whatever enters the same zone for that much more is not needed: whichever way is to be gone
        on from there costs no more from this use.
        """
        zone = self._network.uses[use].target
        after = self._network.leaving[zone]
        if layer == len(self._via):
            after = [*after, *self._ends.get(zone, ())]
        costs = (self._true_cost(use, number) - self._cost(zone, number, 0.0) for number in after)
        return max(costs, default=0)

    def _follower(self, layer: int) -> Callable[[int, int, int, Turns], None]:
        """Return what lets all that may follow a state in a zone wait for their turn."""
        waiting, known, bounds, push = self._waiting, self._before, self._bounds, heapq.heappush
        offset, stride, apply = layer * self._stride, self._stride, self._apply
        aim, ends = (self._via[layer], {}) if layer < len(self._via) else (-1, self._ends)

        # who goes on from a door at once by the same door has gained nothing, but for having been
        # in a zone of `via`, or at a door that makes the way to it cheap
        back = [] if apply or self._via else self._network.back

        def follow(state: int, paid: int, zone: int, turns: Turns) -> None:
            barred = back[state] if back and state >= 0 else -1
            for use, target, step, exact in self._at_terms(zone, turns) if apply else turns:
                after = offset + use if target != aim else offset + use + stride
                if after not in known and use != barred:
                    cost = paid + step
                    mark = EXACT if exact else paid
                    push(waiting, (cost + bounds[use], -cost, after, state, mark))
            for end in ends.get(zone, ()):
                cost = paid + self._cost(zone, end, math.dist(*self._points(state, end)))
                push(waiting, (cost, -cost, offset + end, state, paid))

        return follow

    def _turns_of(self, use: int) -> Turns:
        """Return what may follow a use; what is found out of it is kept."""
        known = self._turns.get(use)
        if known is None:
            known = [(*turn, False) for turn in self._network.row(use)]
            if self._network.turns <= TURNS_MAX:
                self._turns[use] = known
        return known

    def _at_terms(self, zone: int, turns: Turns) -> Turns:
        """Return of turns those that are not closed, at their price."""
        factor = self._terms.factor
        return [
            (use, target, math.ceil(step * factor(zone, use)), exact)
            for use, target, step, exact in turns
            if not self._is_closed(use)
        ]

    def _is_closed(self, use: int) -> bool:
        """Say whether a use must not be gone by, or leads where none may enter."""
        zones, uses = self._terms.closed_zones, self._terms.closed_uses
        return use in uses or self._network.uses[use].target in zones

    def _true_cost(self, before: int, state: int) -> int:
        """Return what it costs to go on from one state to another, along the true way."""
        number, last = state % self._stride, before % self._stride
        if before < 0 or number >= self._count:
            zone = self._errand.start[0] if before < 0 else self._network.uses[last].target
            return self._cost(zone, number, self._legs(zone, *self._points(before, number)))
        zone, place = self._network.uses[last].target, self._places[number]
        turns = self._turns.get(last)  # none where there are too many to be kept
        if turns is not None and turns[place][3]:
            cost = turns[place][2]
        else:
            metres = self._legs(zone, *self._points(before, number))
            cost = self._network.model.units(metres, 1)
            if turns is not None:
                turns[place] = (number, self._network.uses[number].target, cost, True)
        return math.ceil(cost * self._terms.factor(zone, number)) if self._apply else cost

    def _cost(self, zone: int, number: int, metres: float) -> int:
        """Return what a way of so many metres inside a zone costs, to a use or a goal."""
        cost = self._network.model.units(metres, int(number < self._count))
        return math.ceil(cost * self._terms.factor(zone, number)) if self._apply else cost

    def _points(self, state: int, number: int) -> tuple[Point, Point]:
        """Return where a state is, and where a use or goal is."""
        uses, goals = self._network.uses, self._errand.goals
        here = uses[state % self._stride].passage.point if state >= 0 else self._errand.start[1]
        if number < self._count:
            return here, uses[number].passage.point
        return here, goals[number - self._count][1]

    def _uses_until(self, state: int) -> tuple[int, ...]:
        """Return the uses on the way to a state, in order."""
        found: list[int] = []
        while state >= 0:
            found.append(state % self._stride)
            state = self._before[state]
        return tuple(reversed(found))
