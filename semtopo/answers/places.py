"""Answers about zones: where they are, what lies next to them, what they are called."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TypeAlias

import shapely

from semtopo.answers.bearings import zone_here, zone_of, zones_of, zones_of_class
from semtopo.answers.values import (
    ClassesAnswer,
    Frontier,
    FrontiersAnswer,
    HereAnswer,
    ListedClass,
    ListedZone,
    LocationAnswer,
    NeighboursAnswer,
    ReachableAnswer,
    ReachingAnswer,
    ZonePlace,
    ZonesAnswer,
)
from semtopo.atlas import Atlas
from semtopo.borders import border_pieces
from semtopo.errors import UnknownBorderError, UnknownPositionError
from semtopo.graph import Passage
from semtopo.notes import ZoneNotes
from semtopo.phrases import at, counted, listed
from semtopo.questions import (
    ClassesQuestion,
    FrontiersQuestion,
    HereQuestion,
    LocationQuestion,
    NeighboursQuestion,
    ReachableQuestion,
    ReachingQuestion,
    ZonesQuestion,
)
from semtopo.route import widest_place
from semtopo.types import Floats, Occupancy

_FRONTIERS_TOLD = 3

PlaceQuestion: TypeAlias = (
    HereQuestion
    | LocationQuestion
    | NeighboursQuestion
    | ReachableQuestion
    | ReachingQuestion
    | ZonesQuestion
    | ClassesQuestion
    | FrontiersQuestion
)
PlaceAnswer: TypeAlias = (
    HereAnswer
    | LocationAnswer
    | NeighboursAnswer
    | ReachableAnswer
    | ReachingAnswer
    | ZonesAnswer
    | ClassesAnswer
    | FrontiersAnswer
)


def answer_place(  # noqa: C901, PLR0911 -- one line for each kind
    atlas: Atlas, question: PlaceQuestion
) -> PlaceAnswer:
    """Answer a question about zones."""
    match question:
        case HereQuestion():
            return here(atlas)
        case LocationQuestion():
            return location(atlas, question)
        case NeighboursQuestion():
            return neighbours(atlas, question)
        case ReachableQuestion():
            return reachable(atlas, question)
        case ReachingQuestion():
            return reaching(atlas, question)
        case ZonesQuestion():
            return zones(atlas, question)
        case ClassesQuestion():
            return classes(atlas)
        case FrontiersQuestion():
            return frontiers(atlas, question)


def here(atlas: Atlas) -> HereAnswer:
    """Answer where the robot is; raises UnknownPositionError where nothing of it is known."""
    position = atlas.state.position
    try:
        zone = zone_here(atlas)
    except UnknownPositionError as unknown:
        if position is None:
            raise
        return HereAnswer(f"You are {at(position)}. {unknown}", None, position)
    where = "" if position is None else f", {at(position)}"
    return HereAnswer(f"You are in {zone}{where}.", zone, position)


def location(atlas: Atlas, question: LocationQuestion) -> LocationAnswer:
    """Answer where the zones of a name are."""
    regions = {key: zone.region for key, zone in atlas.state.metric.zones.items()}
    places = tuple(
        ZonePlace(zone_id, widest_place(atlas, zone_id), regions[zone_id].area)
        for zone_id in zones_of(atlas, question.zone)
    )
    told = [f"{it.zone} is {at(it.point)}, with {it.area:.1f} m^2" for it in places]
    return LocationAnswer(f"{listed(told)}.", places)


def neighbours(atlas: Atlas, question: NeighboursQuestion) -> NeighboursAnswer:
    """Answer which zones a passage links with a zone."""
    zone = zone_of(atlas, question.zone)
    passages = [one for one in atlas.state.graph.passages.values() if zone in one.key[:2]]
    others = [one.target if one.source == zone else one.source for one in passages]
    found = tuple(dict.fromkeys(others))
    sentence = f"Next to {zone} {'are' if len(found) > 1 else 'is'} {_beside(zone, passages)}."
    return NeighboursAnswer(sentence, zone, found, tuple(passages))


def _beside(zone: str, passages: Sequence[Passage]) -> str:
    """Name what lies next to a zone, and through which points one gets there, or comes from."""
    onwards = {one.target: one for one in passages if one.source == zone}
    back = {one.source: one for one in passages if one.target == zone}
    told = [f"{other} (out {at(one.point)})" for other, one in onwards.items()]
    only_back = [other for other in back if other not in onwards]
    told += [f"{other} (only the way in is known, {at(back[other].point)})" for other in only_back]
    return listed(told) if told else "no zone that is known"


def reachable(atlas: Atlas, question: ReachableQuestion) -> ReachableAnswer:
    """Answer which zones can be reached from a zone; what is closed is not used."""
    zone = zone_of(atlas, question.zone)
    found = _spread(atlas, zone, backwards=False)
    return ReachableAnswer(f"From {zone} one reaches {_named(found)}.", zone, found)


def reaching(atlas: Atlas, question: ReachingQuestion) -> ReachingAnswer:
    """Answer from which zones a zone can be reached; what is closed is not used."""
    zone = zone_of(atlas, question.zone)
    found = _spread(atlas, zone, backwards=True)
    return ReachingAnswer(f"One reaches {zone} from {_named(found)}.", zone, found)


def _named(zones: Sequence[str]) -> str:
    return listed(zones) if zones else "no other zone"


def _spread(atlas: Atlas, zone: str, *, backwards: bool) -> tuple[str, ...]:
    """Return the other zones to which open passages lead from a zone, or from which to it."""
    limits = atlas.limits
    leading: dict[str, list[str]] = {}
    for one in atlas.state.graph.passages.values():
        if one.key not in limits.closed_passages and one.target not in limits.closed_zones:
            source, target = (one.target, one.source) if backwards else (one.source, one.target)
            leading.setdefault(source, []).append(target)
    found, waiting = {zone}, [zone]
    while waiting:
        new = set(leading.get(waiting.pop(), ())) - found
        found |= new
        waiting += new
    return tuple(other for other in atlas.state.graph.nodes if other in found and other != zone)


def zones(atlas: Atlas, question: ZonesQuestion) -> ZonesAnswer:
    """Answer which zones there are, of all or of a class."""
    named = question.zone_class
    found = atlas.state.graph.nodes if named is None else zones_of_class(atlas, named)
    listing = tuple(_listed(atlas, zone) for zone in found)
    if not listing:
        return ZonesAnswer("No zone is known yet.", ())
    told = f": {listed([it.zone for it in listing])}"
    are = "is" if len(listing) == 1 else "are"
    return ZonesAnswer(f"There {are} {counted(len(listing), 'zone')}{told}.", listing)


def _listed(atlas: Atlas, zone: str) -> ListedZone:
    notes = atlas.notes.get(zone, ZoneNotes())
    return ListedZone(zone, atlas.state.graph.nodes[zone].label, notes.zone_class, notes.aliases)


def classes(atlas: Atlas) -> ClassesAnswer:
    """Answer which classes there are, in order of their names, with their zones."""
    members: dict[str, list[str]] = {}
    for zone in atlas.state.graph.nodes:
        of = atlas.notes.get(zone, ZoneNotes()).zone_class
        if of is not None:
            members.setdefault(of, []).append(zone)
    found = tuple(ListedClass(name, tuple(members[name])) for name in sorted(members))
    if not found:
        return ClassesAnswer("No zone has a class yet.", ())
    told = listed([f"{it.zone_class} ({counted(len(it.zones), 'zone')})" for it in found])
    are = "is" if len(found) == 1 else "are"
    return ClassesAnswer(f"There {are} {told}.", found)


def frontiers(atlas: Atlas, question: FrontiersQuestion) -> FrontiersAnswer:
    """Answer where a zone is not explored yet; raises UnknownBorderError in a map without borders.

    Frontiers of the same length are in the order of the zone's rings.
    """
    zone = zone_of(atlas, question.zone)
    mapped = atlas.state.metric.zones[zone]
    if not mapped.border.is_known:
        raise UnknownBorderError("The map holds no borders, so its frontiers are not known.")
    free = [piece.line for piece in border_pieces(mapped) if piece.occupancy is Occupancy.FREE]
    found = sorted(_frontiers(free), key=lambda one: -one.length)
    if not found:
        sentence = f"Nothing: walls and passages are all around {zone}."
        return FrontiersAnswer(sentence, zone, ())
    extent = f"{sum(one.length for one in found):.1f} m of frontier"
    told = listed([f"{one.length:.1f} m {at(one.point)}" for one in found[:_FRONTIERS_TOLD]])
    sentence = f"Unexplored in {zone}: {extent} in {counted(len(found), 'piece')}, first {told}."
    return FrontiersAnswer(sentence, zone, tuple(found))


def _frontiers(lines: Iterable[Floats]) -> Iterable[Frontier]:
    for line in map(shapely.LineString, lines):
        ((x, y),) = shapely.get_coordinates(line.interpolate(0.5, normalized=True))
        yield Frontier((float(x), float(y)), line.length)
