"""What a scan adds to the topology graph (Alg. 3, the lines on V and E).

In comes a scan in its place on the map; out goes a new graph, and what is new in it. First come the
merges that the scan led to, then what it found, in the order of Algorithm 3.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace

import numpy as np
import shapely

from semtopo.crossings import pieces_of
from semtopo.doorways import ends_of
from semtopo.geometry import Polygons, nearest_point, union
from semtopo.graph import (
    Event,
    Gone,
    Node,
    NodeFound,
    NodeMerged,
    Passage,
    PassageFound,
    PassageJoined,
    PassageKey,
    TopologyGraph,
)
from semtopo.metric import here_first
from semtopo.placement import Placement
from semtopo.sensor_map import Link
from semtopo.types import Passages


def extend(
    graph: TopologyGraph, placed: Placement, seq: int, kept: Passages = Passages.FIRST
) -> tuple[TopologyGraph, tuple[Event, ...]]:
    """Return the graph with the findings of one scan, at step `seq`, and the events.

    A passage is new if its pair of zones had none; where all are kept, if none of that pair leads
    through its doorway (R10). Where nothing is new, the graph is this very object.
    """
    merged, merges = _merged(graph, placed, seq, kept)
    links = [*placed.sensor_map.links]
    if kept is Passages.FIRST:
        links = [it for it in links if not _is_linked(*_pair(it, placed), placed, merged.passages)]
    if not links and all(zone_id in merged.nodes for zone_id in placed.names.values()):
        return merged, merges
    nodes, passages = dict(merged.nodes), dict(merged.passages)
    events: list[Event] = []
    for zone_id, label, completed in _in_order(placed, links):
        if zone_id not in nodes:  # Alg. 3, l. 10 and 26
            nodes[zone_id] = Node(zone_id, label, seq)
            events.append(NodeFound(label, zone_id))
        for (source, target, number), entered in _ways(completed, placed, passages, kept):
            point = nearest_point(union(entered), placed.sensor_map.position)
            found = Passage(source, target, point, seq, number)
            passages[found.key] = found  # Alg. 3, l. 19-22 and 27
            events.append(PassageFound(source, target, point, number))
    if not events:
        return merged, merges
    return TopologyGraph(nodes, passages, merged.gone), (*merges, *events)


def _in_order(placed: Placement, links: Iterable[Link]) -> Iterator[tuple[str, str, list[Link]]]:
    """Yield id and label of each zone of a scan, with the links that are complete once it is known.

    That is the order of Alg. 3, l. 13-29.
    """
    names = placed.names
    labels = {names[zone.name]: zone.label for zone in here_first(placed.sensor_map)}
    rank = {zone_id: number for number, zone_id in enumerate(labels)}
    completed: dict[str, list[Link]] = {zone_id: [] for zone_id in labels}
    for link in links:
        completed[max(_pair(link, placed), key=rank.__getitem__)].append(link)
    for zone_id, mine in completed.items():
        yield zone_id, labels[zone_id], mine


def _pair(link: Link, placed: Placement) -> tuple[str, str]:
    """Return the zone ids of source and target."""
    source, target = link.ends
    return placed.names[source], placed.names[target]


def _ways(
    links: list[Link],
    placed: Placement,
    passages: Mapping[PassageKey, Passage],
    kept: Passages,
) -> Iterator[tuple[PassageKey, Polygons]]:
    """Yield the keys of the new passages that links speak for, each with what one enters there."""
    seen: dict[tuple[str, str], list[Link]] = {}
    for link in links:
        source, target = _pair(link, placed)
        if source != target:
            seen.setdefault((source, target), []).append(link)
    for (source, target), leading in seen.items():
        ways = _by_doorway(source, target, placed) if kept is Passages.ALL else {}
        if not ways and not _is_linked(source, target, placed, passages):
            ways = {
                0: [link.strips for link in leading]
            }  # the first passage, or one whose doorway was not seen
        for number in sorted(ways):
            if (source, target, number) not in passages:
                yield (source, target, number), np.concatenate(ways[number])


def _is_linked(
    source: str, target: str, placed: Placement, passages: Mapping[PassageKey, Passage]
) -> bool:
    """Say whether any passage leads from one zone to another: its number is that of a doorway."""
    if (source, target, 0) in passages:
        return True
    doors = placed.metric.doorways.between(source, target)
    return any((source, target, door.number) in passages for door in doors)


def _by_doorway(source: str, target: str, placed: Placement) -> dict[int, list[Polygons]]:
    """Return the numbers of the doorways that beams crossed from one zone to another.

    With each comes what they entered of the target.
    """
    entered: dict[int, list[Polygons]] = {}
    for seen in placed.sensor_map.doorways:
        if (placed.names[seen.source], placed.names[seen.target]) == (source, target):
            for door in placed.metric.doorways.between(source, target):
                crossed = shapely.intersects(door.region, pieces_of(seen.corners))
                if crossed.any():
                    entered.setdefault(door.number, []).append(seen.ground(crossed))
    return entered


def _merged(
    graph: TopologyGraph, placed: Placement, seq: int, kept: Passages
) -> tuple[TopologyGraph, tuple[Event, ...]]:
    """Return the graph after zones, or doorways where these matter, have become one."""
    if not placed.merges and not (placed.joins and kept is Passages.ALL):
        return graph, ()
    events: list[Event] = [NodeMerged(*pair) for pair in placed.merges.items()]
    nodes = {key: node for key, node in graph.nodes.items() if key not in placed.merges}
    gone = [
        Gone(node, rank, seq)
        for rank, (node, until) in enumerate(graph.every_node())
        if until is None and node.zone_id in placed.merges
    ]
    stay = [key for key in graph.passages if _after(key, placed, kept) == key]
    passages = {key: graph.passages[key] for key in stay}
    for rank, (edge, until) in enumerate(graph.every_passage()):
        if until is not None or edge.key in passages:
            continue
        gone.append(Gone(edge, rank, seq))
        source, target, number = key = _after(edge.key, placed, kept)
        if (source, target) == edge.key[:2]:
            events.append(PassageJoined(*edge.key, number))
        if source != target and key not in passages:
            passages[key] = replace(edge, source=source, target=target, number=number, moved=seq)
    return TopologyGraph(nodes, passages, (*graph.gone, *gone)), tuple(events)


def _after(key: PassageKey, placed: Placement, kept: Passages) -> PassageKey:
    """Return the key of a passage after the merges and joins of a step."""
    source, target = (placed.merges.get(end, end) for end in key[:2])
    door = (*ends_of(*key[:2]), key[2])
    while kept is Passages.ALL and door in placed.joins:
        door = placed.joins[door]
    return (source, target, door[2])
