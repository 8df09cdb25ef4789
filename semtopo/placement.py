"""Which zone of the map each zone of a scan is (R14).

By their labels, one word is one zone. As instances, a zone of the scan is the zone of the map of
the same label that it touches; if it touches none, it is a new one; if it touches several, or makes
them touch, these are one place, and merge into the one that was found first.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import count

import numpy as np

from semtopo.doorways import DoorwayKey
from semtopo.geometry import Polygons, groups_touching
from semtopo.metric import MappedZone, MetricMap, here_first
from semtopo.sensor_map import SensorMap
from semtopo.types import Identity, MappingOptions, SeenName
from semtopo.zones import Zone


@dataclass(frozen=True, slots=True, eq=False)
class Placement:
    """A scan in its place on the map: the map with it, and what its zones are there.

    `names` are the zone ids of the zones of the scan. `merges` lead from the ids of zones that are
    no more since this step to those of the zones that have them; `joins` do so for doorways.
    """

    sensor_map: SensorMap
    metric: MetricMap
    names: Mapping[SeenName, str]
    merges: Mapping[str, str]
    joins: Mapping[DoorwayKey, DoorwayKey]

    @property
    def here(self) -> str | None:
        """The id of the zone where the robot is."""
        name = self.sensor_map.here_name
        return None if name is None else self.names[name]


def place(metric: MetricMap, sensor_map: SensorMap, options: MappingOptions, seq: int) -> Placement:
    """Fuse a scan into the map, at step `seq` (Alg. 3, the lines on M_m)."""
    tolerance = options.tolerance
    if options.identity is Identity.LABEL:
        names: dict[SeenName, str] = {zone.name: zone.label for zone in sensor_map.zones}
        return _placed(metric, sensor_map, names, {}, seq, tolerance)
    names, merges = _instances(metric, sensor_map)
    while True:
        placed = _placed(metric, sensor_map, names, merges, seq, tolerance)
        late = _late_merges(placed.metric, set(names.values()))
        if not late:
            return placed
        names = {name: late.get(zone_id, zone_id) for name, zone_id in names.items()}
        merges = {
            zone_id: late.get(into, into)
            for zone_id, into in {**late, **merges}.items()
            if zone_id in metric.zones
        }


def _placed(
    metric: MetricMap,
    sensor_map: SensorMap,
    names: Mapping[SeenName, str],
    merges: Mapping[str, str],
    seq: int,
    tolerance: float,
) -> Placement:
    """Return a scan in its place, once it is known what its zones are."""
    after = metric.fused(sensor_map, names, merges, seq, tolerance)
    former = after.doorways.former
    new = list(former)[len(metric.doorways.former) :]
    return Placement(sensor_map, after, names, merges, {key: former[key] for key in new})


def _instances(
    metric: MetricMap, sensor_map: SensorMap
) -> tuple[dict[SeenName, str], dict[str, str]]:
    """Return which zone of the map each zone of a scan is, and which zones that merges."""
    names: dict[SeenName, str] = {}
    merges: dict[str, str] = {}
    zones = here_first(sensor_map)
    for label in dict.fromkeys(zone.label for zone in zones):
        seen = [zone for zone in zones if zone.label == label]
        known = _of_label(metric, label)
        for group in groups_touching(_regions(seen), _regions(known)):
            ids = [known[place - len(seen)].zone_id for place in group if place >= len(seen)]
            zone_id = ids[0] if ids else _new_id(label, metric, names.values())
            merges.update(dict.fromkeys(ids[1:], zone_id))
            names.update((seen[place].name, zone_id) for place in group if place < len(seen))
    return names, merges


def _late_merges(metric: MetricMap, grown: set[str]) -> dict[str, str]:
    """Return which zones merge into others, since they touch now that both have grown.

    That is due to rounding alone, for what touches the zones of the scan was found before.
    """
    merges: dict[str, str] = {}
    for label in sorted({metric.zones[zone_id].label for zone_id in grown}):
        known = _of_label(metric, label)
        probes = [zone for zone in known if zone.zone_id in grown]
        others = [zone for zone in known if zone.zone_id not in grown]
        for group in groups_touching(_regions(probes), _regions(others)):
            ids = {[*probes, *others][place].zone_id for place in group}
            first, *rest = [zone.zone_id for zone in known if zone.zone_id in ids]
            merges.update(dict.fromkeys(rest, first))
    return merges


def _of_label(metric: MetricMap, label: str) -> list[MappedZone]:
    """Return the zones of a label, in order of finding."""
    return [zone for zone in metric.zones.values() if zone.label == label]


def _regions(zones: Iterable[Zone | MappedZone]) -> Polygons:
    return np.array([zone.region for zone in zones], dtype=np.object_)


def _new_id(label: str, metric: MetricMap, others: Iterable[str]) -> str:
    """Return an id that no zone has or had: the label, else the label with the next number."""
    taken = set(others)
    numbered = (label if number == 1 else f"{label}-{number}" for number in count(1))
    return next(
        name
        for name in numbered
        if name not in metric.zones and name not in metric.former and name not in taken
    )
