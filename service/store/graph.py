"""Rows of the graph: its nodes are the zones, its edges the passages, with those that were."""

from __future__ import annotations

from sqlalchemy import Connection, bindparam, insert, select, update

from semtopo.graph import Gone, Node, Passage, PassageKey, TopologyGraph
from service.statements import Statement, run
from service.tables import passages, zones

_ADD = Statement(insert(passages))

_KEY = ("session", "source", "target", "number")

_END = Statement(
    update(passages)
    .where(*(passages.c[name] == bindparam(f"at_{name}") for name in _KEY))
    .values(until=bindparam("until"))
)


def load_graph(connection: Connection, session: int) -> TopologyGraph:
    """Return the graph of a session as it is, which knows what it was."""
    heads = (zones.c.zone_id, zones.c.label, zones.c.since, zones.c.position, zones.c.until)
    query = select(*heads).where(zones.c.session == session).order_by(zones.c.position)
    nodes: dict[str, Node] = {}
    edges: dict[PassageKey, Passage] = {}
    gone: list[Gone] = []
    for row in connection.execute(query):
        node = Node(row.zone_id, row.label, row.since)
        if row.until is None:
            nodes[node.zone_id] = node
        else:
            gone.append(Gone(node, row.position, row.until))
    wanted = select(passages).where(passages.c.session == session).order_by(passages.c.position)
    for row in connection.execute(wanted):
        edge = Passage(row.source, row.target, (row.x, row.y), row.seq, row.number, row.moved)
        if row.until is None:
            edges[edge.key] = edge
        else:
            gone.append(Gone(edge, row.position, row.until))
    gone.sort(key=lambda it: it.until)  # stable: of one step, nodes come first
    return TopologyGraph(nodes, edges, tuple(gone))


def save_passages(
    connection: Connection, session: int, before: TopologyGraph, after: TopologyGraph
) -> None:
    """Write the passages that a step found, moved or ended."""
    if after is before:
        return
    gone = after.gone[len(before.gone) :]
    ended = [(it.was.key, it.until) for it in gone if isinstance(it.was, Passage)]
    for key, until in ended:
        values = dict(zip(_KEY, (session, *key), strict=True))
        run(connection, _END, {f"at_{name}": values[name] for name in _KEY} | {"until": until})
    position = len(before.every_passage()) if before.gone else len(before.passages)
    for edge in list(after.passages.values())[len(before.passages) - len(ended) :]:
        values = {
            "session": session, "source": edge.source, "target": edge.target,
            "number": edge.number, "position": position, "x": edge.point[0], "y": edge.point[1],
            "seq": edge.seq, "moved": edge.moved, "until": None,
        }  # fmt: skip
        run(connection, _ADD, values)
        position += 1
