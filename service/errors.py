"""What can go wrong in the service, beyond what can in the library. These errors know no HTTP."""

from __future__ import annotations

from typing import ClassVar

from semtopo.errors import InvalidInputError, SemtopoError


class UnknownSessionError(SemtopoError):
    """No session has that id."""

    code: ClassVar[str] = "unknown_session"


class NoWorldError(SemtopoError):
    """A step without a scan was sent to a session that has no world to sense."""

    code: ClassVar[str] = "no_world"


class MapFullError(SemtopoError):
    """A map has become too large to grow further; begin another session."""

    code: ClassVar[str] = "map_full"


class SequenceGapError(SemtopoError):
    """A step's `seq` is beyond the next one."""

    code: ClassVar[str] = "sequence_gap"

    def __init__(self, expected: int) -> None:
        """Name the `seq` that may come next."""
        super().__init__(f"the next step of this session is {expected}")
        self.expected = expected
        self.facts = {"expected": expected}


class SequenceReusedError(SemtopoError):
    """A step's `seq` was taken already, with another input."""

    code: ClassVar[str] = "sequence_reused"


class KeyReusedError(SemtopoError):
    """An Idempotency-Key was used already, with another input."""

    code: ClassVar[str] = "key_reused"


class VersionMismatchError(SemtopoError):
    """The map is no longer the one that If-Match names."""

    code: ClassVar[str] = "version_mismatch"


class InvalidRequestError(InvalidInputError):
    """A header or parameter that cannot be used."""

    code: ClassVar[str] = "invalid_request"


class UnauthorizedError(SemtopoError):
    """The request brought no valid API key."""

    code: ClassVar[str] = "unauthorized"


class InvalidKeyNameError(InvalidInputError):
    """An API key cannot have that name."""

    code: ClassVar[str] = "invalid_key_name"


class UnknownKeyError(SemtopoError):
    """No valid API key has that name."""

    code: ClassVar[str] = "unknown_key"


class InvalidDatabaseError(InvalidInputError):
    """A database URL that cannot be used."""

    code: ClassVar[str] = "invalid_database"


class BusyError(SemtopoError):
    """Too many steps are waiting; come again."""

    code: ClassVar[str] = "busy"


class PictureError(SemtopoError):
    """A picture could not be painted, or takes too long."""

    code: ClassVar[str] = "picture_failed"


class StorageError(SemtopoError):
    """The database did not take the change; the same request may be sent again."""

    code: ClassVar[str] = "storage_unavailable"


class NameTakenError(SemtopoError):
    """An alias is the name of another zone already."""

    code: ClassVar[str] = "name_taken"


class UnknownPassageError(SemtopoError):
    """The map has no such passage."""

    code: ClassVar[str] = "unknown_passage"


class UnknownRestrictionError(SemtopoError):
    """The session has no such restriction, or it has been lifted or has expired."""

    code: ClassVar[str] = "unknown_restriction"


class NotesFullError(SemtopoError):
    """A session has as many restrictions, or changes of names and restrictions, as it may."""

    code: ClassVar[str] = "notes_full"
