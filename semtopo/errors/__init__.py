"""Name everything that can go wrong, without knowing who will be told.

    SemtopoError
    ├── InvalidInputError (also a ValueError): what was handed in cannot be used
    │   ├── InvalidWorldError
    │   ├── InvalidSensorError
    │   ├── InvalidPoseError
    │   ├── InvalidPathError
    │   ├── InvalidScanError
    │   ├── InvalidOptionError
    │   ├── InvalidMapError
    │   ├── InvalidQuestionError
    │   │   └── CrowdedQuestionError
    │   └── InvalidRestrictionError
    ├── UnknownZoneError: no zone of the map has that name
    ├── AmbiguousZoneError: a name means several zones where one is asked for
    ├── OutsideError: a place is not in free space
    ├── TooNarrowError: there is a way, but not for a robot of that radius
    ├── NotConnectedError: two places lie in parts of free space that do not meet
    ├── UnprovedPathError: a path failed its check, and was not handed out
    ├── AmbiguousQuestionError: a sentence asks different things
    ├── UnknownPositionError: it is not known in which zone the robot is
    ├── UnknownStepError: a step was not taken, or nothing is known of it
    ├── UnknownBorderError: the map holds no borders
    └── NoRouteError: both zones are known, but no passage leads on

Each leaf has a `code` that never changes: programs may depend on it. The text is for people, and
never repeats what came in at length.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar


class SemtopoError(Exception):
    """Any error of this package; `code` names it for programs.

    `facts` are what a program may want to know besides, as JSON values by name.
    """

    code: ClassVar[str] = "semtopo_error"
    facts: Mapping[str, object] = {}


class InvalidInputError(SemtopoError, ValueError):
    """What was handed in cannot be used; nothing was changed."""

    code: ClassVar[str] = "invalid_input"


class InvalidWorldError(InvalidInputError):
    """A world has no zones, or a zone without extent, or the like."""

    code: ClassVar[str] = "invalid_world"


class InvalidSensorError(InvalidInputError):
    """A sensor with too few samples, no range, or the like."""

    code: ClassVar[str] = "invalid_sensor"


class InvalidPoseError(InvalidInputError):
    """A pose that is not finite."""

    code: ClassVar[str] = "invalid_pose"


class InvalidPathError(InvalidInputError):
    """A path that holds a line which is not a pose."""

    code: ClassVar[str] = "invalid_path"


class InvalidScanError(InvalidInputError):
    """A scan whose radii do not ascend, or the like."""

    code: ClassVar[str] = "invalid_scan"


class InvalidOptionError(InvalidInputError):
    """A mapping option out of its range."""

    code: ClassVar[str] = "invalid_option"


class NotExportableError(SemtopoError):
    """A map cannot be written in a format: it has too much for it, or nothing."""

    code: ClassVar[str] = "not_exportable"


class InvalidMapError(InvalidInputError):
    """A stored map that cannot be read back."""

    code: ClassVar[str] = "invalid_map"


class InvalidQuestionError(InvalidInputError):
    """A sentence that leaves the grammar: `expected` says what was missing at `position`.

    The position is in characters from 0; `example` is a question of the kind that was begun.
    """

    code: ClassVar[str] = "invalid_question"

    def __init__(self, message: str, position: int, expected: str, example: str) -> None:
        """Keep what was missing, and where."""
        super().__init__(message)
        self.position, self.expected, self.example = position, expected, example
        self.facts = {"position": position, "expected": expected, "example": example}


class CrowdedQuestionError(InvalidQuestionError):
    """A sentence that names more zones to go to, or to avoid, than one question may."""

    code: ClassVar[str] = "crowded_question"


class InvalidRestrictionError(InvalidInputError):
    """A restriction whose factor is out of range, or the like."""

    code: ClassVar[str] = "invalid_restriction"


class UnknownZoneError(SemtopoError):
    """No zone of the map has that name; `closest` are known names that are like it.

    In a sentence, `position` is where the name stands, in characters from 0.
    """

    code: ClassVar[str] = "unknown_zone"

    def __init__(
        self, message: str, closest: tuple[str, ...] = (), position: int | None = None
    ) -> None:
        """Keep the names that may have been meant, the likest first."""
        super().__init__(message)
        self.closest, self.position = closest, position
        self.facts = {"closest": closest, **({} if position is None else {"position": position})}


class AmbiguousZoneError(SemtopoError):
    """A name means several zones where one is asked for: `candidates`, or some of them.

    In a sentence, `position` is where the name stands, in characters from 0.
    """

    code: ClassVar[str] = "ambiguous_zone"

    def __init__(
        self, message: str, candidates: tuple[str, ...], position: int | None = None
    ) -> None:
        """Keep the zones, or names, that may have been meant."""
        super().__init__(message)
        self.candidates, self.position = candidates, position
        where = {} if position is None else {"position": position}
        self.facts = {"candidates": candidates, **where}


class AmbiguousQuestionError(SemtopoError):
    """A sentence that asks different things, as the map has it; `readings` says each in full."""

    code: ClassVar[str] = "ambiguous_question"

    def __init__(self, message: str, readings: tuple[str, ...]) -> None:
        """Keep what may have been meant."""
        super().__init__(message)
        self.readings = readings
        self.facts = {"readings": readings}


class UnknownPositionError(SemtopoError):
    """It is not known in which zone the robot is."""

    code: ClassVar[str] = "unknown_position"


class UnknownStepError(SemtopoError):
    """The step was not taken yet, or nothing is known of it."""

    code: ClassVar[str] = "unknown_step"


class UnknownBorderError(SemtopoError):
    """The borders of zones are not known, as in a map that was read back from its bodies."""

    code: ClassVar[str] = "unknown_border"
