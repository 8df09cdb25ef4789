"""Notes: what people call the zones of a map, and what they closed or made costly in it.

Plain values; which zones and passages there are is not their business.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

from semtopo.errors import InvalidRestrictionError
from semtopo.graph import PassageKey

FACTOR_MIN, FACTOR_MAX = 0.001, 1_000_000.0
"""How much less or more a restriction may let a way cost: a thousandth, a million times."""


@dataclass(frozen=True, slots=True)
class ZoneNotes:
    """What people call a zone beside its label: other names for it, and the class it is of."""

    aliases: tuple[str, ...] = ()
    zone_class: str | None = None


@dataclass(frozen=True, slots=True)
class ZoneRef:
    """One zone, by its id."""

    zone_id: str


@dataclass(frozen=True, slots=True)
class LabelRef:
    """Every zone of a label."""

    label: str


Restricted: TypeAlias = PassageKey | ZoneRef | LabelRef
"""What a restriction is on: one passage, one zone, or all zones of a label."""


@dataclass(frozen=True, slots=True)
class Restriction:
    """Something is closed, or costs `factor` times what it costs else.

    It holds while the time is before `expires_at`, in s since the epoch; always, if that is `None`.
    `since` is the step after which it was made, and `was` what it was made on, where that has
    become a part of something else since.

    Raises
    ------
    InvalidRestrictionError
        The factor is not between `FACTOR_MIN` and `FACTOR_MAX`.
    """

    id: str
    on: Restricted
    closed: bool = False
    factor: float = 1.0
    expires_at: float | None = None
    since: int = 0
    was: Restricted | None = None

    def __post_init__(self) -> None:
        """Refuse a factor out of range."""
        if not FACTOR_MIN <= self.factor <= FACTOR_MAX:
            raise InvalidRestrictionError(f"factor must be {FACTOR_MIN} to {FACTOR_MAX:.0f}")

    def holds(self, now: float) -> bool:
        """Say whether it holds at a time."""
        return self.expires_at is None or now < self.expires_at
