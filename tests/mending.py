"""Mend drawn requests where a service demands more than a schema can say.

What is left as it was drawn: everything that the schema allows and the service takes.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from schemathesis import Case

from tests.servers import Json

AnyCase = Case[Any]

SCAN: Json = {
    "angle_min": 0,
    "angle_increment": 0.1,
    "range_max": 2,
    "beams": [[["a", 1], ["b", 2]]] * 60,
}


@dataclass(frozen=True, slots=True)
class Known:
    """A session that exists: its id, its last step, two of its zones, and what restricts one."""

    session: str
    seq: int
    zones: tuple[str, str]
    restrict: Callable[[], str]
    """Restricts a zone, and returns the id of the restriction."""


def mend(case: AnyCase, known: Known) -> None:
    """Let a case be about what there is."""
    _mend_query(case, known)
    if "zone_id" in case.path_parameters:
        case.path_parameters["zone_id"] = known.zones[0]
    if "restriction_id" in case.path_parameters:
        case.path_parameters["restriction_id"] = known.restrict()
    body: Any = case.body
    if isinstance(body, dict):
        ending = case.path.rpartition("/")[2]
        _MENDERS.get(ending, _leave)(body, known)
        if ending == "step":
            for name in ("If-Match", "Idempotency-Key"):
                case.headers.pop(name, None)


def _mend_query(case: AnyCase, known: Known) -> None:
    """Let a moment be in the history, a box a box, and a way one between known zones."""
    query = case.query
    if isinstance(query.get("at"), int):
        query["at"] %= known.seq + 1
    if "bbox" in query:
        query["bbox"] = "0,0,20,20"
    if case.path.endswith("/route"):
        for name in ("via", "avoid", "avoid_passage", "x", "y", "at"):
            query.pop(name, None)
        query["from"], query["to"] = known.zones


def _leave(_body: Json, _known: Known) -> None:
    """Leave a body as it is."""


def _mend_step(body: Json, _known: Known) -> None:
    """Let a step follow on the one before, and its radii ascend within the range."""
    body.pop("seq", None)
    scan = body.get("scan")
    if not isinstance(scan, dict):
        body["scan"] = SCAN
        return
    beams, reach = scan.get("beams"), scan.get("range_max")
    if (
        isinstance(beams, list)
        and isinstance(reach, int | float)
        and all(_is_beam(beam) for beam in beams)
    ):
        within = [{r: label for label, r in beam if r <= reach} for beam in beams]
        scan["beams"] = [[[_printable(runs[r]), r] for r in sorted(runs)] for runs in within]
    kinds = scan.get("kinds")
    if isinstance(kinds, dict):
        scan["kinds"] = {_printable(label): kind for label, kind in kinds.items()}


def _is_beam(beam: object) -> bool:
    return isinstance(beam, list) and all(
        isinstance(run, list)
        and len(run) == 2
        and isinstance(run[0], str)
        and isinstance(run[1], int | float)
        for run in beam
    )


def _mend_names(body: Json, _known: Known) -> None:
    """Let names be printable, and each another."""
    if isinstance(body.get("aliases"), list):
        body["aliases"] = [
            f"{number} {_printable(it)}" for number, it in enumerate(body["aliases"])
        ]
    if isinstance(body.get("class"), str):
        body["class"] = _printable(body["class"])


def _mend_restriction(body: Json, known: Known) -> None:
    """Let a restriction be on one thing that exists, and do something."""
    given = [name for name in ("label", "zone", "passage") if body.pop(name, None) is not None]
    body["label" if "label" in given else "zone"] = known.zones[0]
    if not body.get("closed"):
        body["factor"] = 2.5


def _mend_question(body: Json, known: Known) -> None:
    """Ask for a way, in words."""
    body["text"] = f"path from {known.zones[0]} to {known.zones[1]}"


def _printable(text: object) -> str:
    kept = "".join(character for character in str(text)[:90] if character.isprintable())
    return kept.strip() or "name"


_MENDERS: dict[str, Callable[[Json, Known], None]] = {
    "step": _mend_step,
    "{zone_id}": _mend_names,
    "restrictions": _mend_restriction,
    "query": _mend_question,
}
