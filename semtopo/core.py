"""The core of a zone: what its reduced border is made from (R17; the paper's future work).

Simplifying a border again and again wears it away. So each zone keeps a core that is never
simplified, and its border is always made from that, anew. The core takes in a scan only if it goes
beyond the core by more than a part of the tolerance; then it takes in all of it, exactly. So the
core always lies within the union of all scans, and that within the core and a rim of known width:
the error does not grow with the number of steps, and the core stops growing once a place is known.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import shapely

from semtopo.border import Border
from semtopo.fusion import Extent, fuse
from semtopo.geometry import Region, polygonal
from semtopo.sector import Sector
from semtopo.traced import traced

RIM = 0.25
"""Share of the tolerance by which scans may go beyond the core; the rest is for the border."""


MITRE = 5.0
"""Times the rim's width; no corner of it is farther out."""


@dataclass(frozen=True, eq=False)
class Core:
    """What is known of a zone's extent before its border is reduced.

    `tolerance` is in m, above 0.
    """

    extent: Extent
    tolerance: float

    @property
    def region(self) -> Region:
        """The extent of the core in m, map frame."""
        return self.extent.region

    @property
    def border(self) -> Border:
        """The border of the core."""
        return self.extent.border

    def grown(self, seen: Extent, sectors: Sequence[Sector] = ()) -> Core:
        """Return the core with another extent taken in, or itself where that lies within the rim.

        If there are `sectors`, they are what the other consists of.
        """
        if not self._is_left(seen) and self.rim.covers(seen.region):
            return self
        fused = fuse(self.extent, seen, sectors)
        return self if fused is self.extent else Core(fused, self.tolerance)

    def _is_left(self, seen: Extent) -> bool:
        """Say whether a vertex of another extent is certainly beyond the rim.

        To see that costs less than to make the rim, where that is not made yet: while a place is
        being explored, the core changes with every scan.
        """
        if "rim" in vars(self):
            return False
        shapely.prepare(self.region)
        farthest = MITRE * RIM * self.tolerance
        return not shapely.dwithin(self.region, shapely.points(seen.border.xy), farthest).all()

    @cached_property
    def rim(self) -> Region:
        """The region with a rim around it, ready to be asked often what it covers."""
        wide = polygonal(
            shapely.buffer(self.region, RIM * self.tolerance, join_style="mitre", mitre_limit=MITRE)
        )
        shapely.prepare(wide)
        return wide

    def reduced(self) -> Extent:
        """Return the extent with as few vertices as the tolerance allows."""
        chord = (1 - RIM) * self.tolerance
        region = polygonal(shapely.simplify(self.region, chord, preserve_topology=False))
        if region.is_empty or not region.is_valid:
            region = polygonal(shapely.simplify(self.region, chord))
        turned: Region = shapely.orient_polygons(region)
        return Extent(traced(turned, [self.border]), turned)
