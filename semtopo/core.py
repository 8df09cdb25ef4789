"""The core of a zone: what its reduced border is made from (R17; the paper's future work).

Simplifying a border again and again wears it away. So each zone keeps a core that is never
simplified, and its border is always made from that, anew. The core takes in a scan only if it goes
beyond the core by more than a part of the tolerance; then it takes in all of it, exactly. So the
core always lies within the union of all scans, and that within the core and a rim of known width:
the error does not grow with the number of steps, and the core stops growing once a place is known.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import shapely

from semtopo.fusion import box_around, fuse
from semtopo.geometry import Region, polygonal
from semtopo.zones import Border

RIM = 0.25
"""Share of the tolerance by which scans may go beyond the core; the rest is for the border."""


@dataclass(frozen=True, eq=False)
class Core:
    """What is known of a zone's extent before its border is reduced, and its border points.

    `tolerance` is in m, above 0.
    """

    region: Region
    border: Border
    tolerance: float

    def grown(self, region: Region, border: Border) -> Core:
        """Return the core with a region taken in, or itself where that lies within the rim."""
        if self.rim.covers(region):
            return self
        fused = fuse(self.region, region)
        if fused is self.region:
            return self
        around = self.border.updated(border, fused, box_around(region))
        return Core(fused, around, self.tolerance)

    @cached_property
    def rim(self) -> Region:
        """The region with a rim around it, ready to be asked often what it covers."""
        wide = polygonal(shapely.buffer(self.region, RIM * self.tolerance, join_style="mitre"))
        shapely.prepare(wide)
        return wide

    def reduced(self) -> tuple[Region, Border]:
        """Return the region with as few vertices as the tolerance allows, and its border points."""
        chord = (1 - RIM) * self.tolerance
        region = polygonal(shapely.simplify(self.region, chord, preserve_topology=False))
        if region.is_empty or not region.is_valid:
            region = polygonal(shapely.simplify(self.region, chord))
        return region, self.border.on(region)
