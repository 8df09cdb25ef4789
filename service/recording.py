"""Decide, inside the transaction, what becomes of a step: recorded, answered as before, or refused.

The order of the questions matters: a retry whose answer was lost must get that answer, also where
the map has moved on since. So the Idempotency-Key comes first, then `seq`, then If-Match.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypeAlias

from sqlalchemy import Connection

from semtopo import LabelledRuns, Pose, SemtopoError, Step
from service import store
from service.errors import (
    KeyReusedError,
    SequenceGapError,
    SequenceReusedError,
    VersionMismatchError,
)
from service.hot import HotSession, map_tag


@dataclass(frozen=True, slots=True, kw_only=True)
class StepRequest:
    """A step as it was asked for; `input` is its JSON, `fingerprint` the SHA-256 of that."""

    pose: Pose
    seen: LabelledRuns | None
    input: str
    fingerprint: bytes
    seq: int | None = None
    key: str | None = None
    if_match: frozenset[str] | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Computed:
    """A step that was computed, and is to be recorded; `cpu_ms` is what it took of a processor."""

    step: Step
    answer: str
    taken_at: str
    timings_ms: Mapping[str, float]
    cpu_ms: float


@dataclass(frozen=True, slots=True)
class Recorded:
    """The step is stored."""


@dataclass(frozen=True, slots=True)
class Replayed:
    """The step had been stored before; this was its answer."""

    seq: int
    answer: str


@dataclass(frozen=True, slots=True)
class Stale:
    """The map is no longer the one that the step was computed on."""


Outcome: TypeAlias = Recorded | Replayed | Stale | SemtopoError
"""What became of a step; an error is returned, not raised, since others share the transaction."""


def record(
    connection: Connection, request: StepRequest, hot: HotSession, computed: Computed | None
) -> Outcome:
    """Record a step, or say why not. Without `computed`, only an earlier answer can be given."""
    earlier = _earlier(connection, request, hot)
    if earlier is not None:
        return earlier
    refusal = _refusal(request, hot)
    if refusal is not None:
        current = store.find_version(connection, hot.row.id) or ()
        return refusal if current[:2] == (hot.row.number, hot.seq) else Stale()
    if computed is None or not store.advance(connection, hot.row.number, hot.seq):
        return Stale()
    after = computed.step.state
    logged = store.LoggedStep(
        after.seq, computed.taken_at, request.key, request.fingerprint,
        request.input, computed.answer,
    )  # fmt: skip
    store.add_step(connection, hot.row.number, logged)
    store.save_changes(connection, hot.row, hot.state, after)
    return Recorded()


def _earlier(connection: Connection, request: StepRequest, hot: HotSession) -> Outcome | None:
    """Return the answer to the same step, if it was taken before, or the refusal of another."""
    number = hot.row.number
    if request.key is not None:
        logged = store.find_step_by_key(connection, number, request.key)
        if logged is not None:
            reused = KeyReusedError("this Idempotency-Key came with another step before")
            return _answer(logged, request, reused)
    if request.seq is not None and request.seq <= hot.seq:
        logged = store.find_step(connection, number, request.seq)
        if logged is not None:
            return _answer(logged, request, SequenceReusedError("another step has this seq"))
    return None


def _answer(logged: store.LoggedStep, request: StepRequest, reused: SemtopoError) -> Outcome:
    same = logged.fingerprint == request.fingerprint
    return Replayed(logged.seq, logged.answer) if same else reused


def _refusal(request: StepRequest, hot: HotSession) -> SemtopoError | None:
    """Return why a step cannot follow on the map of `hot`, if it cannot."""
    following = hot.seq + 1
    if request.seq is not None and request.seq > following:
        return SequenceGapError(following)
    if request.if_match is not None and not {"*", hot.tag} & set(map(map_tag, request.if_match)):
        return VersionMismatchError("the map is no longer the one that If-Match names")
    return None
