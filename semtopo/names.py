"""Names: which zones people mean by an id, a label, an alias or a class.

In come an atlas and a name; out go zone ids. Names are compared as they are, then in
Unicode's form NFC, then without regard to case.
"""

from __future__ import annotations

import unicodedata
from collections.abc import Callable, Iterator
from heapq import nlargest

from semtopo.atlas import Atlas
from semtopo.errors import AmbiguousZoneError, UnknownZoneError

NAMES_TOLD_MAX = 5
"""How many close names or candidates are told."""

_LIKENESS_MIN = 0.4  # of 1; with less in common, hardly anybody would take one for the other


def resolve(atlas: Atlas, name: str) -> tuple[str, ...]:
    """Return the zones that a name means, in order of finding: an id, a label, an alias or a class.

    The first of these that fits wins; a label or a class may mean several zones. What fits as it is
    written wins over what fits but for case.

    Raises
    ------
    UnknownZoneError
        No zone has that name.
    AmbiguousZoneError
        Several names that mean different zones differ from this one in case alone.
    """
    for form in (str, _written, folded):
        wanted = form(name)
        for names in _tiers(atlas):
            meanings: dict[str, list[str]] = {}
            for known, zone_id in names:
                if form(known) == wanted:
                    meanings.setdefault(_written(known), []).append(zone_id)
            if len({tuple(zones) for zones in meanings.values()}) > 1:
                raise AmbiguousZoneError("several names differ in case alone", _few(meanings))
            if meanings:
                return tuple(dict.fromkeys(next(iter(meanings.values()))))
    raise UnknownZoneError("the map has no zone of that name", closest_names(atlas, name))


def resolve_one(atlas: Atlas, name: str) -> str:
    """Return the one zone that a name means.

    Raises
    ------
    UnknownZoneError
        No zone has that name.
    AmbiguousZoneError
        Several zones have it.
    """
    zones = resolve(atlas, name)
    if len(zones) > 1:
        raise AmbiguousZoneError("several zones have that name", _few(zones))
    return zones[0]


def resolve_class(atlas: Atlas, name: str) -> tuple[str, ...]:
    """Return the zones of a class, in order of finding; a label counts as one, after classes.

    Raises
    ------
    UnknownZoneError
        There is no such class and no such label.
    """
    for form in (str, _written, folded):
        for names in (_classes(atlas), _labels(atlas)):
            zones = tuple(zone for known, zone in names if form(known) == form(name))
            if zones:
                return zones
    raise UnknownZoneError("the map has no zone of that class", closest_names(atlas, name))


def closest_names(atlas: Atlas, name: str) -> tuple[str, ...]:
    """Return up to `NAMES_TOLD_MAX` known names that are like a name, the likest first."""
    wanted = _pairs(name)
    names = dict.fromkeys(_written(known) for tier in _tiers(atlas) for known, _ in tier)
    likeness = {known: _likeness(wanted, _pairs(known)) for known in names}
    alike = [known for known, likeness in likeness.items() if likeness >= _LIKENESS_MIN]
    return tuple(nlargest(NAMES_TOLD_MAX, alike, key=likeness.__getitem__))


def known_names(atlas: Atlas) -> tuple[str, ...]:
    """Return every name that means something: ids, labels, aliases and classes, each once."""
    return tuple(dict.fromkeys(name for tier in _tiers(atlas) for name, _ in tier))


def _pairs(name: str) -> set[str]:
    """Return the pairs of neighbouring characters of a name, its ends marked; case counts not."""
    marked = f"\n{folded(name)}\n"
    return {marked[at : at + 2] for at in range(len(marked) - 1)}


def _likeness(one: set[str], other: set[str]) -> float:
    """Return how much two sets have in common, from 0 to 1 (Dice's coefficient)."""
    return 2 * len(one & other) / (len(one) + len(other))


def _written(name: str) -> str:
    return unicodedata.normalize("NFC", name)


def folded(name: str) -> str:
    """Return a name in the form in which those are alike that differ in case alone."""
    return unicodedata.normalize("NFC", unicodedata.normalize("NFC", name).casefold())


_Names = Callable[[Atlas], Iterator[tuple[str, str]]]


def _tiers(atlas: Atlas) -> Iterator[Iterator[tuple[str, str]]]:
    """Yield names with the zones they mean, kind by kind."""
    yield from (kind(atlas) for kind in (_ids, _labels, _aliases, _classes))


def _ids(atlas: Atlas) -> Iterator[tuple[str, str]]:
    return ((zone_id, zone_id) for zone_id in atlas.state.graph.nodes)


def _labels(atlas: Atlas) -> Iterator[tuple[str, str]]:
    return ((node.label, node.zone_id) for node in atlas.state.graph.nodes.values())


def _aliases(atlas: Atlas) -> Iterator[tuple[str, str]]:
    return ((it, zone) for zone in _noted(atlas) for it in atlas.notes[zone].aliases)


def _classes(atlas: Atlas) -> Iterator[tuple[str, str]]:
    noted = ((atlas.notes[zone].zone_class, zone) for zone in _noted(atlas))
    return ((it, zone) for it, zone in noted if it is not None)


def _noted(atlas: Atlas) -> Iterator[str]:
    """Yield the zones that have notes, in order of finding."""
    return (zone for zone in atlas.state.graph.nodes if zone in atlas.notes)


def _few(names: object) -> tuple[str, ...]:
    assert isinstance(names, dict | tuple)  # noqa: S101 -- called by this room alone
    return tuple(names)[:NAMES_TOLD_MAX]
