"""The topology graph in DOT, the language of Graphviz.

Nodes are named z0, z1, ... in order of finding; `zone_id` tells which zone they are. A backslash is
doubled and a quotation mark gets one before it, as the language wants; in `label`, which is what is
drawn, an ampersand is `&amp;`.
"""

from __future__ import annotations

from collections.abc import Iterator

from semtopo.exports.attributes import Attributes, passage_attributes, zone_attributes
from semtopo.exports.chart import Chart
from semtopo.mapper import MapState


def dot_body(chart: Chart) -> bytes:
    """Return the graph in DOT."""
    return ("\n".join(_lines(chart.state)) + "\n").encode()


def _lines(state: MapState) -> Iterator[str]:
    """Yield the statements of the graph."""
    yield "digraph semtopo {"
    names = {zone_id: f"z{number}" for number, zone_id in enumerate(state.graph.nodes)}
    for zone_id, name in names.items():
        known = zone_attributes(state.metric.zones[zone_id])
        drawn = zone_id.replace("&", "&amp;")
        told: Attributes = {**known, "label": drawn, "zone_id": zone_id, "class": known["label"]}
        yield f"  {name} [{_listed(told)}];"
    for edge in state.graph.passages.values():
        ends = f"{names[edge.source]} -> {names[edge.target]}"
        yield f"  {ends} [{_listed(passage_attributes(edge))}];"
    yield "}"


def _listed(attributes: Attributes) -> str:
    return ", ".join(f"{name}={_written(value)}" for name, value in attributes.items())


def _written(value: str | float) -> str:
    """Return a value; a text always in quotes, so that nothing in it means anything."""
    if isinstance(value, str):
        return '"' + value.replace("\\", "\\\\").replace('"', '\\"') + '"'
    return f'"{value!r}"'
