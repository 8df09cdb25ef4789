"""What every export is made from: a map, and the stretches of its borders."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import shapely

from semtopo.codec import Document
from semtopo.doorways import Doorways
from semtopo.geometry import Region
from semtopo.mapper import MapState
from semtopo.metric import MetricMap


@dataclass(frozen=True, slots=True, eq=False)
class Chart:
    """A map to be exported, and its borders as the features of `borders_body`.

    `radius` in m is that of the robot that is to find its way, and `work_max` how much may be done
    to find it, in corners of a zone times places between which ways are looked for; 100,000 take
    some 10 s. Not every format has ways.
    """

    state: MapState
    borders: Sequence[Document]
    radius: float = 0.0
    work_max: int | None = None

    def __post_init__(self) -> None:
        """Turn all rings as they are written, so that a map read back gives the same bytes."""
        metric = self.state.metric
        known = {key: replace(it, region=_turned(it.region)) for key, it in metric.doorways.items()}
        turned = MetricMap(dict(metric.zones), Doorways(known))
        object.__setattr__(self, "state", replace(self.state, metric=turned))


def _turned(region: Region) -> Region:
    turned: Region = shapely.orient_polygons(region)
    return turned
