"""Names: which zones people mean by an id, a label, an alias or a class.

In come an atlas and a name; out go zone ids. Names are compared as they are, then in
Unicode's form NFC, then without regard to case.
"""

from __future__ import annotations

import unicodedata
from collections.abc import Callable, Iterable, Mapping
from functools import cached_property, lru_cache

from semtopo.atlas import Atlas
from semtopo.errors import AmbiguousZoneError, UnknownZoneError
from semtopo.following import Former, Same, zone_now
from semtopo.graph import TopologyGraph
from semtopo.likeness import NameLikeness
from semtopo.notes import ZoneNotes

NAMES_TOLD_MAX = 5
"""How many close names or candidates are told."""

DIRECTORIES_KEPT = 16
"""Maps whose names are at hand at once."""

_Meanings = dict[str, tuple[str, ...]]
"""Zone ids by name."""


def resolve(atlas: Atlas, name: str) -> tuple[str, ...]:
    """Return the zones that a name means, in order of finding: an id, a label, an alias or a class.

    The first of these that fits wins; a label or a class may mean several zones. What fits as it is
    written wins over what fits but for case. Last comes the id of a zone that has become a part of
    another (R14): it means that one.

    Raises
    ------
    UnknownZoneError
        No zone has that name.
    AmbiguousZoneError
        Several names that mean different zones differ from this one in case alone.
    """
    directory = directory_of(atlas)
    for form in _FORMS:
        for tier in directory.tiers:
            meanings = tier.meanings(form, name)
            if len(set(meanings.values())) > 1:
                raise AmbiguousZoneError("several names differ in case alone", _few(meanings))
            if meanings:
                return next(iter(meanings.values()))
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
    directory = directory_of(atlas)
    for form in _FORMS:
        for tier in (directory.classes, directory.labels):
            meanings = tier.meanings(form, name).values()
            zones = {zone for of_one in meanings for zone in of_one}
            if zones:
                return tuple(zone for zone in atlas.state.graph.nodes if zone in zones)
    raise UnknownZoneError("the map has no zone of that class", closest_names(atlas, name))


def closest_names(atlas: Atlas, name: str) -> tuple[str, ...]:
    """Return up to `NAMES_TOLD_MAX` known names that are like a name, the likest first."""
    return directory_of(atlas).likeness.closest(folded(name), NAMES_TOLD_MAX)


def folded(name: str) -> str:
    """Return a name in the form in which those are alike that differ in case alone."""
    return _written(_written(name).casefold())


def _written(name: str) -> str:
    return name if name.isascii() else unicodedata.normalize("NFC", name)


_FORMS: tuple[Callable[[str], str], ...] = (str, _written, folded)


class Tier:
    """Names of one kind, with the zones that each means."""

    def __init__(self, names: Iterable[tuple[str, str]]) -> None:
        """Take names with a zone that each means, in order of finding."""
        found: dict[str, dict[str, None]] = {}
        for name, zone in names:
            found.setdefault(name, {})[zone] = None
        self.zones: _Meanings = {name: tuple(zones) for name, zones in found.items()}

    @cached_property
    def alike(self) -> dict[str, list[str]]:
        """The names, by the form in which case does not matter."""
        found: dict[str, list[str]] = {}
        for name in self.zones:
            found.setdefault(folded(name), []).append(name)
        return found

    def meanings(self, form: Callable[[str], str], name: str) -> _Meanings:
        """Return the names of which a form is that of a name, as they are written, and zones."""
        wanted = form(name)
        meant: dict[str, tuple[str, ...]] = {}
        for known in self.alike.get(folded(name), ()):
            if form(known) == wanted:
                written = _written(known)
                zones = (*meant.get(written, ()), *self.zones[known])
                meant[written] = tuple(dict.fromkeys(zones))
        return meant


class Directory:
    """All names of a map: ids, labels, aliases, classes."""

    def __init__(
        self, graph: TopologyGraph, notes: Mapping[str, ZoneNotes], former: Former
    ) -> None:
        """Take the zones of a map, what they are called besides, and where former ones went."""
        self.ids, self.labels = _tiers_of_graph(graph)
        noted = [(zone, notes[zone]) for zone in graph.nodes if zone in notes] if notes else []
        self.aliases = Tier((alias, zone) for zone, of in noted for alias in of.aliases)
        self.classes = Tier(
            (of.zone_class, zone) for zone, of in noted if of.zone_class is not None
        )
        ended = ((it, zone_now(graph, former, it)) for it in former if it not in graph.nodes)
        self.former = Tier((it, now) for it, now in ended if now in graph.nodes)
        self.current = (self.ids, self.labels, self.aliases, self.classes)
        self.tiers = (*self.current, self.former)

    @cached_property
    def folded_names(self) -> frozenset[str]:
        """All names, in the form in which case does not matter."""
        return frozenset().union(*(tier.alike for tier in self.tiers))

    @cached_property
    def likeness(self) -> NameLikeness:
        """Tells which names are like another."""
        forms = {
            _written(name): form
            for tier in self.current
            for form, names in tier.alike.items()
            for name in names
        }
        return NameLikeness(forms)


def directory_of(atlas: Atlas) -> Directory:
    """Return the names of an atlas; it is kept, for the next question about the same map."""
    state = atlas.state
    return _directory_of(state.graph, Same(atlas.notes), Same(state.metric.former))


@lru_cache(maxsize=DIRECTORIES_KEPT)
def _directory_of(
    graph: TopologyGraph, notes: Same[Mapping[str, ZoneNotes]], former: Same[Former]
) -> Directory:
    return Directory(graph, notes.value, former.value)


@lru_cache(maxsize=DIRECTORIES_KEPT)
def _tiers_of_graph(graph: TopologyGraph) -> tuple[Tier, Tier]:
    """Return the ids and the labels of a graph; one and the same where no two differ."""
    ids = Tier((zone, zone) for zone in graph.nodes)
    labels = [(node.label, zone) for zone, node in graph.nodes.items()]
    return ids, ids if all(label == zone for label, zone in labels) else Tier(labels)


def _few(names: Iterable[str]) -> tuple[str, ...]:
    return tuple(names)[:NAMES_TOLD_MAX]
