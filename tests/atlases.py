"""Atlases for tests of names, routes and sentences: graphs laid over simple zones."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import shapely

from semtopo.atlas import Atlas
from semtopo.fusion import Extent
from semtopo.geometry import Region
from semtopo.graph import Node, Passage, TopologyGraph
from semtopo.mapper import MapState
from semtopo.metric import MappedZone, MetricMap
from semtopo.types import Point

Edge = tuple[str, str, Point] | tuple[str, str, Point, int]
"""Source, target, point, and number if it is not the first between the two."""

EVERYWHERE = shapely.box(-64, -64, 64, 64)
"""A region in which every way is straight."""


def mapped(zone_id: str, region: Region, label: str | None = None) -> MappedZone:
    """Return a zone of a map, of whose border nothing is known."""
    return MappedZone(zone_id, label or zone_id, Extent.of(region), since=1, seq=1)


def atlas(
    edges: Iterable[Edge],
    zones: Iterable[str] | Mapping[str, Region] = (),
    labels: Mapping[str, str] | None = None,
    **more: Any,  # noqa: ANN401 -- notes, restrictions and now, as Atlas takes them
) -> Atlas:
    """Return an atlas whose passages were found step by step, in the order given.

    Zones that are not given come from the edges. Without a region, a zone is everywhere.
    """
    found = [Passage(*edge[:3], seq, *edge[3:]) for seq, edge in enumerate(edges, start=1)]
    ends = [end for passage in found for end in (passage.source, passage.target)]
    regions = zones if isinstance(zones, Mapping) else dict.fromkeys(zones, EVERYWHERE)
    regions = {**regions, **{end: EVERYWHERE for end in ends if end not in regions}}
    names = labels or {}
    known = {zone: mapped(zone, region, names.get(zone)) for zone, region in regions.items()}
    nodes = {zone: Node(zone, names.get(zone, zone), 1) for zone in regions}
    graph = TopologyGraph(nodes, {passage.key: passage for passage in found})
    return Atlas(MapState(len(found), MetricMap(known), graph), **more)
