"""Write a map for other programs: each format in a file of its own, as bytes.

In come values; out go documents that the programs' own readers take. The same map gives the same
bytes. Lengths are in m, map frame.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum

from semtopo.exports.chart import Chart
from semtopo.exports.dot import dot_body
from semtopo.exports.geojson import geojson_body
from semtopo.exports.graphml import graphml_body
from semtopo.exports.nav2 import nav2_body
from semtopo.exports.spark_dsg import spark_dsg_body

RADIUS_MAX = 10.0
"""m; a robot that needs to find a way through rooms is smaller."""


class Format(StrEnum):
    """A format in which a map can be written."""

    GEOJSON = "geojson"
    GRAPHML = "graphml"
    DOT = "dot"
    NAV2 = "nav2"
    SPARK_DSG = "spark-dsg"


@dataclass(frozen=True, slots=True)
class Export:
    """How a format is written, and its media type."""

    write: Callable[[Chart], bytes]
    media_type: str


EXPORTS: dict[Format, Export] = {
    Format.GEOJSON: Export(geojson_body, "application/geo+json"),
    Format.GRAPHML: Export(graphml_body, "application/graphml+xml"),
    Format.DOT: Export(dot_body, "text/vnd.graphviz"),
    Format.NAV2: Export(nav2_body, "application/geo+json"),
    Format.SPARK_DSG: Export(spark_dsg_body, "application/json"),
}
"""Every format."""
