"""The metric map M_m: what is known of each zone's extent (Alg. 3, the lines on M_m).

In come the zones of one scan; out goes a new map. Maps are values: a step makes a new one, and the
old one stays as it was.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType

from semtopo.border import Border
from semtopo.core import Core
from semtopo.doorways import Doorways
from semtopo.fusion import Extent, fuse
from semtopo.geometry import Region
from semtopo.sensor_map import SensorMap
from semtopo.types import SeenName
from semtopo.zones import Zone


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True)
class MappedZone:
    """A zone of the map z_m.

    `zone_id` is the instance, `label` the class; with one zone for each label (R14) they are the
    same word. `since` is the step that found the zone, `seq` the last step that changed it. With a
    tolerance, the extent is made from the `core` (R17).
    """

    zone_id: str
    label: str
    extent: Extent
    since: int
    seq: int
    core: Core | None = None

    @property
    def region(self) -> Region:
        """The extent of the zone in m, map frame."""
        return self.extent.region

    @property
    def border(self) -> Border:
        """The border of the region."""
        return self.extent.border


@dataclass(frozen=True, slots=True, eq=False)
class MetricMap:
    """The metric map M_m: zones by `zone_id`, in the order in which they were found.

    What is known to be free is the zones and the `doorways` between them. `former` leads from the
    ids of zones that are no more to those of the zones that they became part of (R14); such an id
    is never used again.
    """

    zones: Mapping[str, MappedZone] = field(default_factory=dict)
    doorways: Doorways = field(default_factory=Doorways)
    former: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Let nobody change the zones from here on."""
        object.__setattr__(self, "zones", MappingProxyType(self.zones))

    def fused(
        self,
        sensor_map: SensorMap,
        names: Mapping[SeenName, str],
        merges: Mapping[str, str],
        seq: int,
        tolerance: float = 0.0,
    ) -> MetricMap:
        """Return the map with the zones of one scan fused in, at step `seq`.

        `names` says which zone of the map each of the scan is, by its id. Alg. 3, l. 4-11 for the
        zone where the robot is, l. 13-29 for the others. Before, zones are merged into others, from
        the first id of `merges` to the second (R14); their doorways move over. A zone that grows
        by nothing stays the very same object. Borders are kept within a `tolerance` in m (R17).
        """
        if not sensor_map.zones and not merges:
            return self
        zones = dict(self.zones)
        for zone_id, into in merges.items():
            zones[into] = _grown(zones[into], zones.pop(zone_id), seq, tolerance)
        for seen in here_first(sensor_map):
            zone_id = names[seen.name]
            known = zones.get(zone_id)
            if known is None:
                zones[zone_id] = _new(zone_id, seen, seq, tolerance)
            else:
                zones[zone_id] = _grown(known, seen, seq, tolerance)
        between = [((names[it.source], names[it.target]), it.corners) for it in sensor_map.doorways]
        doorways = self.doorways.updated(between, merges, seq)
        return MetricMap(zones, doorways, {**self.former, **merges} if merges else self.former)

    def changed_since(self, older: MetricMap) -> list[MappedZone]:
        """Return the zones that differ from those of an older map."""
        return [zone for key, zone in self.zones.items() if older.zones.get(key) is not zone]


def here_first(sensor_map: SensorMap) -> list[Zone]:
    """Return the zones in the order of Algorithm 3: where the robot is, then by name."""
    if len(sensor_map.zones) == 1:
        return list(sensor_map.zones)
    return sorted(sensor_map.zones, key=lambda zone: (zone.name != sensor_map.here_name, zone.name))


def _new(zone_id: str, seen: Zone, seq: int, tolerance: float) -> MappedZone:
    zone = MappedZone(zone_id, seen.label, seen.extent, since=seq, seq=seq)
    return _around(zone, Core(seen.extent, tolerance), seq) if tolerance > 0 else zone


def _grown(known: MappedZone, seen: Zone | MappedZone, seq: int, tolerance: float) -> MappedZone:
    """Return a known zone with another fused in (Alg. 3, l. 5-7 and 16-18; R12)."""
    sectors = seen.sectors if isinstance(seen, Zone) else ()
    if tolerance > 0:
        core = known.core or Core(known.extent, tolerance)
        other = (isinstance(seen, MappedZone) and seen.core) or seen
        grown = core.grown(other.extent, sectors)
        return known if grown is core else _around(known, grown, seq)
    extent = fuse(known.extent, seen.extent, sectors)
    if extent is known.extent:
        return known
    return MappedZone(known.zone_id, known.label, extent, known.since, seq)


def _around(zone: MappedZone, core: Core, seq: int) -> MappedZone:
    """Return a zone whose extent is made from a core."""
    return replace(zone, extent=core.reduced(), core=core, seq=seq)
