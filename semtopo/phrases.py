"""Words out: questions as sentences that read back to them, and the parts that answers are made of.

Coordinates and lengths are in m, map frame.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields

from semtopo.questions import (
    ChangesQuestion,
    ClassesQuestion,
    ConnectionQuestion,
    DistanceQuestion,
    FrontiersQuestion,
    Here,
    HereQuestion,
    Leg,
    LocationQuestion,
    Named,
    Nearest,
    NearestQuestion,
    NeighboursQuestion,
    PathQuestion,
    Question,
    ReachableQuestion,
    ReachingQuestion,
    SeenQuestion,
    ZonesQuestion,
)
from semtopo.types import Point

TOLD_MAX = 20
"""How many names a sentence lists; there may be thousands."""


_FORMS: dict[type[Question], tuple[str, ...]] = {
    PathQuestion: ("path from {start} to {legs}",),
    ConnectionQuestion: ("is there a way from {start} to {legs}",),
    DistanceQuestion: ("how far is it from {start} to {goal}",),
    NearestQuestion: ("nearest {zone_class} from {start}",),
    HereQuestion: ("where am I",),
    LocationQuestion: ("where is {zone}",),
    NeighboursQuestion: ("what is next to {zone}",),
    ReachableQuestion: ("which zones are reachable from {zone}",),
    ReachingQuestion: ("from which zones can {zone} be reached",),
    SeenQuestion: ("what did I see at step {step}",),
    ChangesQuestion: (
        "what changed since step {since}",
        "what changed between step {since} and {until}",
    ),
    ZonesQuestion: ("list zones", "list zones of class {zone_class}"),
    ClassesQuestion: ("list classes",),
    FrontiersQuestion: ("what is unexplored in {zone}",),
}
"""How each kind of question is asked; the last form takes all of its fields."""


def phrase(question: Question) -> str:
    """Return a sentence that asks a question: parsed, it is the same question again."""
    values = {field.name: getattr(question, field.name) for field in fields(question)}
    forms = _FORMS[type(question)]
    form = forms[0] if None in values.values() else forms[-1]
    return form.format(**{name: _words(value) for name, value in values.items()})


def _words(value: object) -> str:
    """Return a part of a question in words."""
    match value:
        case Here():
            return "here"
        case Named(name):
            return quoted(name)
        case Nearest(zone_class):
            return f"the nearest {_words(zone_class)}"
        case Leg(goal, via, avoiding):
            clauses = {"via": via, "avoiding": avoiding}
            return _words(goal) + "".join(f" {it} {_names(of)}" for it, of in clauses.items() if of)
        case tuple():
            return " and then to ".join(map(_words, value))
        case _:
            return str(value)


def _names(names: Sequence[Named]) -> str:
    return " and ".join(map(_words, names))


def quoted(name: str) -> str:
    """Return a name in quotation marks, those in it doubled."""
    return '"' + name.replace('"', '""') + '"'


def listed(names: Sequence[str], last: str = "and") -> str:
    """Return up to `TOLD_MAX` names in a row, and how many there are beyond; at least one."""
    told = list(names[:TOLD_MAX])
    if len(names) > len(told):
        told.append(f"{len(names) - len(told)} more")
    return f"{', '.join(told[:-1])} {last} {told[-1]}" if len(told) > 1 else told[0]


def at(point: Point) -> str:
    """Return where a point is, to a decimetre."""
    return f"at ({point[0]:.1f}, {point[1]:.1f})"


def counted(number: int, noun: str) -> str:
    """Return a number of things; `noun` takes an s."""
    return f"1 {noun}" if number == 1 else f"{number} {noun}s"


def capitalised(sentence: str) -> str:
    """Return a sentence with a capital letter first."""
    return sentence[:1].upper() + sentence[1:]
