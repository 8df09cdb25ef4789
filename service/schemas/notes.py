"""What people note about a map: names of zones, and restrictions."""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

from semtopo.documents import Document, Label, Number
from semtopo.errors import InvalidRestrictionError
from service.changes import Restrict

ALIASES_MAX = 10
EXPIRES_IN_MAX = 1e9  # s; some thirty years
NUMBER_MAX = 10_000


class ZoneNotesRequest(Document):
    """What people call a zone, in place of what was noted before."""

    model_config = ConfigDict(extra="forbid", frozen=True, populate_by_name=True)

    aliases: Annotated[tuple[Label, ...], Field(max_length=ALIASES_MAX)] = ()
    zone_class: Annotated[Label | None, Field(alias="class")] = None


class ZoneNotesAnswer(BaseModel):
    """A zone, and what people call it."""

    id: str
    label: str
    aliases: list[str]
    zone_class: Annotated[str | None, Field(alias="class")]


class PassageName(Document):
    """A passage, by the zones it links and its number between them; zones by any name."""

    source: Label
    target: Label
    n: Annotated[int, Field(strict=True, ge=0, le=NUMBER_MAX)] = 0


class RestrictionRequest(Document):
    """Closes a passage, a zone or all zones of a label, or makes ways there cost more or less.

    `factor` multiplies what they cost; `expires_in` is in s. One thing has one restriction: a new
    one takes the place of the one before, and keeps its id.
    """

    passage: PassageName | None = None
    zone: Label | None = None
    label: Label | None = None
    closed: Annotated[bool, Field(strict=True)] = False
    factor: Number = 1.0
    expires_in: Annotated[Number | None, Field(gt=0, le=EXPIRES_IN_MAX)] = None

    def value(self) -> Restrict:
        """Return what is asked for; raises InvalidRestrictionError."""
        if sum(it is not None for it in (self.passage, self.zone, self.label)) != 1:
            raise InvalidRestrictionError("a restriction is on a passage, a zone or a label")
        if not self.closed and self.factor == 1:
            raise InvalidRestrictionError("a restriction closes something or gives it a factor")
        one = self.passage
        return Restrict(
            zone=self.zone,
            label=self.label,
            passage=None if one is None else (one.source, one.target, one.n),
            closed=self.closed,
            factor=self.factor,
            expires_in=self.expires_in,
        )


class PassageRestricted(BaseModel):
    """A passage that is restricted; `n` is its number, where not 0."""

    source: str
    target: str
    n: int | None = None


class Restricted(BaseModel):
    """What a restriction is on: a passage, a zone or a label."""

    passage: PassageRestricted | None = None
    zone: str | None = None
    label: str | None = None


class RestrictionAnswer(Restricted):
    """A restriction, made after step `since`.

    `was` is what it was made on, where that has become a part of what it is on now.
    """

    id: str
    closed: bool
    factor: float
    expires_at: str | None
    since: int
    was: Restricted | None = None


class RestrictionsAnswer(BaseModel):
    """The restrictions that hold, the oldest first, as of step `seq`."""

    seq: int
    restrictions: list[RestrictionAnswer]
