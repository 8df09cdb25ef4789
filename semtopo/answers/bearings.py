"""From the words of a question to the zones of a map; an error names the place of the name."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from semtopo.atlas import Atlas
from semtopo.errors import AmbiguousZoneError, UnknownPositionError, UnknownZoneError
from semtopo.geometry import nearest_point
from semtopo.names import resolve, resolve_class, resolve_one
from semtopo.phrases import listed
from semtopo.questions import Goal, Here, Named, Nearest
from semtopo.questions import Place as Spoken
from semtopo.route import Place


def zone_of(atlas: Atlas, place: Spoken) -> str:
    """Return the one zone that a place means.

    Raises
    ------
    UnknownZoneError
        No zone has the name.
    AmbiguousZoneError
        Several zones have it.
    UnknownPositionError
        It is where the robot is, and that is not known.
    """
    if isinstance(place, Here):
        return zone_here(atlas)
    with _telling_where(place):
        return resolve_one(atlas, place.name)


def zones_of(atlas: Atlas, name: Named) -> tuple[str, ...]:
    """Return all zones that a name means; raises as `zone_of` does."""
    with _telling_where(name):
        return resolve(atlas, name.name)


def zones_of_class(atlas: Atlas, name: Named) -> tuple[str, ...]:
    """Return all zones of a class; raises UnknownZoneError if there is none."""
    with _telling_where(name):
        return resolve_class(atlas, name.name)


def start_of(atlas: Atlas, place: Spoken) -> Place:
    """Return where a way begins; from here, at the place in the zone that is nearest to the robot.

    Raises as `zone_of` does.
    """
    zone_id = zone_of(atlas, place)
    known = atlas.state.metric.zones.get(zone_id)
    if not isinstance(place, Here) or atlas.state.position is None or known is None:
        return Place(zone_id)
    return Place(zone_id, nearest_point(known.region, atlas.state.position))


def goals_of(atlas: Atlas, goal: Goal) -> tuple[Place, ...]:
    """Return the places at which a way may end, of which the nearest counts.

    Raises as `zone_of` does.
    """
    match goal:
        case Here():
            return (start_of(atlas, goal),)
        case Nearest(zone_class):
            return tuple(map(Place, zones_of_class(atlas, zone_class)))
        case Named():
            return tuple(map(Place, zones_of(atlas, goal)))


def zone_here(atlas: Atlas) -> str:
    """Return the zone where the robot is; raises UnknownPositionError if that is not known."""
    if atlas.state.here is None:
        if atlas.state.position is None:
            raise UnknownPositionError("It is not known where the robot is: it took no step yet.")
        raise UnknownPositionError("The robot is in no zone that is known: its last scan saw none.")
    return atlas.state.here


@contextmanager
def _telling_where(name: Named) -> Iterator[None]:
    """Say in the error about a name which name of the question it is, and what may be meant."""
    where = f"at character {name.position + 1}"
    try:
        yield
    except UnknownZoneError as error:
        hint = f"Alike: {listed(error.closest)}." if error.closest else 'Ask "list zones".'
        text = f"The map knows nothing by the name {where}. {hint}"
        raise UnknownZoneError(text, error.closest, name.position) from None
    except AmbiguousZoneError as error:
        text = f"The name {where} may mean {listed(error.candidates, 'or')}; say which."
        raise AmbiguousZoneError(text, error.candidates, name.position) from None
