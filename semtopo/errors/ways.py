"""What is wrong when no route leads to a goal, or no path."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import ClassVar

from semtopo.errors import SemtopoError

ZONES_TOLD_MAX = 100
"""Zones of one kind among the facts of an error; the error itself has them all."""


@dataclass(frozen=True, slots=True)
class MissingPassage:
    """There is no passage from `source` to `target`, but one back, which step `since` found."""

    source: str
    target: str
    since: int


@dataclass(frozen=True, slots=True)
class NearestFrontier:
    """Where exploring may close a gap: a point in m on the frontier of a zone that can be reached.

    `distance` in m is how far it is from there to a zone `towards` from which a goal can be
    reached.
    """

    zone_id: str
    point: tuple[float, float]
    towards: str
    distance: float


class NoRouteError(SemtopoError):
    """The zones are known, but no sequence of passages leads from the one to the other.

    `reachable` are the zones that can be reached from the start, `reaching` those from which a goal
    can be reached, each with the start or the goals themselves, in order of finding. `missing`
    names a pair of these with a passage only the wrong way, and `frontier` the frontier that is
    nearest to closing the gap, where there is such a one. `restricted` says that there would be a
    route if nothing was closed or avoided, `two_way` that there would be one if passages might be
    used against their direction as well, which was not asked for.
    """

    code: ClassVar[str] = "no_route"

    def __init__(  # noqa: PLR0913 -- one for each thing known about a gap
        self,
        message: str,
        *,
        reachable: tuple[str, ...] = (),
        reaching: tuple[str, ...] = (),
        missing: MissingPassage | None = None,
        frontier: NearestFrontier | None = None,
        restricted: bool = False,
        two_way: bool = False,
    ) -> None:
        """Keep what is known about the gap."""
        super().__init__(message)
        self.reachable = reachable
        self.reaching = reaching
        self.missing = missing
        self.frontier = frontier
        self.restricted = restricted
        self.two_way = two_way
        self.facts = {
            "reachable": reachable[:ZONES_TOLD_MAX],
            "reaching": reaching[:ZONES_TOLD_MAX],
            "missing": None if missing is None else asdict(missing),
            "frontier": None if frontier is None else asdict(frontier),
            "restricted": restricted,
            "two_way": two_way,
        }


class OutsideError(SemtopoError):
    """A place is not in free space, or nearer to its border than the robot's radius.

    `end` is "start" or "goal"; `nearest` is the nearest place where the robot may be, in m, map
    frame, None if there is none.
    """

    code: ClassVar[str] = "outside_free_space"

    def __init__(self, end: str, nearest: tuple[float, float] | None, why: str) -> None:
        """Say which end of a path is meant, and why it cannot be one."""
        super().__init__(f"The {end} {why}.")
        self.end, self.nearest = end, nearest
        self.facts = {"end": end, "nearest": nearest}


class TooNarrowError(SemtopoError):
    """Free space leads from start to goal, but nowhere wide enough for the robot.

    Of all ways the widest is meant: `point` is its narrowest place in m, map frame; there it is
    `width` wide, and must be `needed` wide, in m.
    """

    code: ClassVar[str] = "too_narrow"

    def __init__(self, point: tuple[float, float], width: float, needed: float) -> None:
        """Say where it is too narrow, and by how much."""
        x, y = point
        super().__init__(
            f"There is a way, but not for this robot: at ({x:.3f}, {y:.3f}) it is {width:.3f} m"
            f" wide, and must be {needed:.3f} m."
        )
        self.point, self.width, self.needed = point, width, needed
        self.facts = {"point": point, "width": width, "needed": needed}


@dataclass(frozen=True, slots=True)
class GroundlessPassage:
    """A passage at a point in m from zone `source` to zone `target`, without ground between them.

    It was seen, maybe from afar or by a single beam; where one goes through is not known.
    """

    source: str
    target: str
    point: tuple[float, float]


class NotConnectedError(SemtopoError):
    """Start and goal lie in parts of free space that do not meet.

    On the way along a route, `passage` is the first one of which no ground is known, if there is
    such a one.
    """

    code: ClassVar[str] = "not_connected"

    def __init__(self, message: str, passage: GroundlessPassage | None = None) -> None:
        """Keep the passage that has no ground."""
        super().__init__(message)
        self.passage = passage
        self.facts = {"passage": None if passage is None else asdict(passage)}


class UnprovedPathError(SemtopoError):
    """A path did not pass the check that it keeps to free space: a fault of ours."""

    code: ClassVar[str] = "unproved_path"
