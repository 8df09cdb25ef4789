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
    │   └── InvalidQuestionError
    ├── UnknownZoneError: no zone of the map has that name
    └── NoRouteError: both zones are known, but no passage leads on

Each leaf has a `code` that never changes: programs may depend on it. The text is for people, and
never repeats what came in at length.
"""

from __future__ import annotations

from typing import ClassVar


class SemtopoError(Exception):
    """Any error of this package; `code` names it for programs."""

    code: ClassVar[str] = "semtopo_error"


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


class InvalidMapError(InvalidInputError):
    """A stored map that cannot be read back."""

    code: ClassVar[str] = "invalid_map"


class InvalidQuestionError(InvalidInputError):
    """A sentence that is none of the known forms."""

    code: ClassVar[str] = "invalid_question"


class UnknownZoneError(SemtopoError):
    """No zone of the map has that name."""

    code: ClassVar[str] = "unknown_zone"


class NoRouteError(SemtopoError):
    """Both zones are known, but no sequence of passages leads from the one to the other."""

    code: ClassVar[str] = "no_route"
