"""Lay a graph out on a panel: near where its zones lie, with no node upon another node or an edge.

In come the places where the nodes would like to be, their sizes, and which of them are linked; out
come their places. All is in pixels. The same input gives the same layout.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from shapely import STRtree

from semtopo.types import Floats, Integers, Point

_ROUNDS = 400
_WORK_MAX = 40_000  # nodes looked at in all rounds; larger graphs get fewer of them
_ROUNDS_LEAST = 20
_GAP = 14.0  # pixels between two nodes, and between a node and an edge of others
_HOMESICKNESS = 0.01  # of the way home, in the first round
_HUB = 10  # neighbours
_PUSH = 0.3  # of what would be enough against one other alone


@dataclass(frozen=True, slots=True, eq=False)
class Nodes:
    """What is to be laid out: `home` and `half` (half of width and height) (nodes, 2)."""

    home: Floats
    half: Floats
    links: Integers
    """Pairs of nodes, (links, 2), each pair once."""


def lay_out(nodes: Nodes, size: Point) -> Floats:
    """Return the middles of the nodes (nodes, 2) on a panel of a size."""
    low, high = nodes.half + 6, np.maximum(np.array(size) - nodes.half - 6, nodes.half + 6)
    middles = np.clip(_told_apart(nodes.home), low, high)
    hubs = list(_hubs(nodes.links))
    rounds = min(_ROUNDS, max(_WORK_MAX // (len(middles) + 1), _ROUNDS_LEAST))
    for homesick in np.linspace(_HOMESICKNESS, 0, rounds):
        push = _apart(nodes, middles) + _off_edges(nodes, middles) + _fanned(hubs, middles)
        move = homesick * (nodes.home - middles) + _PUSH * push
        middles = np.clip(middles + move, low, high)
    for _ in range(rounds):  # that nodes lie apart matters most
        move = _apart(nodes, middles)
        if not move.any():
            break
        middles = np.clip(middles + _PUSH * move, low, high)
    return middles


def _told_apart(home: Floats) -> Floats:
    """Return places that are all different: each a little off, in a direction of its own."""
    turn = 2.4 * np.arange(len(home))
    return home + 0.5 * np.stack([np.cos(turn), np.sin(turn)], axis=-1)


def _apart(nodes: Nodes, middles: Floats) -> Floats:
    """Return how nodes move (nodes, 2) that are too close: along the axis that needs less."""
    one, other = _near(middles, nodes.half + _GAP / 2)
    between = middles[one] - middles[other]
    overlap = np.maximum(nodes.half[one] + nodes.half[other] + _GAP - np.abs(between), 0)
    along_x = overlap[:, 0] < overlap[:, 1]
    axis = np.stack([along_x, ~along_x], axis=-1)
    return _summed(one, np.where(axis, np.sign(between) * overlap / 2, 0.0), len(middles))


def _near(middles: Floats, half: Floats) -> Integers:
    """Return the pairs (2, n) of rectangles that meet, each pair both ways, in order."""
    boxes = np.asarray(shapely.box(*(middles - half).T, *(middles + half).T))
    pairs = STRtree(boxes).query(boxes)
    pairs = pairs[:, pairs[0] != pairs[1]]
    return pairs[:, np.lexsort(pairs[::-1])]


def _off_edges(nodes: Nodes, middles: Floats) -> Floats:
    """Return how nodes move (nodes, 2) that lie on an edge between two others: straight off it."""
    lines = np.asarray(shapely.linestrings(middles[nodes.links]))
    reach = np.hypot(*nodes.half.T) + _GAP
    pairs = STRtree(lines).query(shapely.points(middles), predicate="dwithin", distance=reach)
    node, link = pairs[:, np.lexsort(pairs[::-1])]
    own = (nodes.links[link] == node[:, None]).any(axis=1)  # its own ends may touch it
    node, link = node[~own], link[~own]
    start, end = middles[nodes.links[link, 0]], middles[nodes.links[link, 1]]
    along, offset = end - start, middles[node] - start
    length = np.maximum((along**2).sum(axis=1), 1e-9)
    share = np.clip((offset * along).sum(axis=1) / length, 0, 1)
    away = offset - share[:, None] * along
    distance = np.maximum(np.hypot(*away.T), 1e-9)[:, None]
    direction = away / distance
    room = (nodes.half[node] * np.abs(direction)).sum(axis=1, keepdims=True) + _GAP
    return _summed(node, direction * np.maximum(room - distance, 0), len(middles))


def _summed(which: Integers, moves: Floats, count: int) -> Floats:
    """Return the sum of the moves (n, 2) of each of `count` nodes."""
    total = np.zeros((count, 2))
    np.add.at(total, which, moves)
    return total


def _hubs(links: Integers) -> Iterator[tuple[int, Integers]]:
    """Yield the nodes that have many neighbours, and those neighbours."""
    both = np.concatenate([links, links[:, ::-1]])
    hubs, degree = np.unique(both[:, 0], return_counts=True)
    for hub in hubs[degree >= _HUB]:
        yield int(hub), both[both[:, 0] == hub, 1]


def _fanned(hubs: Sequence[tuple[int, Integers]], middles: Floats) -> Floats:
    """Return how nodes move (nodes, 2) that crowd on one side of a hub: around it."""
    move = np.zeros_like(middles)
    for hub, spokes in hubs:
        along = middles[spokes] - middles[hub]
        angle = np.arctan2(along[:, 1], along[:, 0])
        order = np.argsort(angle, kind="stable")
        gap = np.diff(angle[order], append=angle[order[0]] + 2 * np.pi)
        lack = np.maximum(0.9 * 2 * np.pi / len(spokes) - gap, 0)
        turn = (np.roll(lack, 1) - lack)[:, None] / 2
        ordered = along[order]
        move[spokes[order]] += turn * np.stack([-ordered[:, 1], ordered[:, 0]], axis=-1)
    return move
