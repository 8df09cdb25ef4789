"""Read a sentence: which question it asks, or where it leaves the grammar and what is missing.

Case, final marks, and an article before further words of a bare name do not matter; a straight
double mark inside such marks is doubled.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, TypeAlias

from lark import Token, Tree, UnexpectedCharacters, UnexpectedToken
from lark.parsers.lalr_interactive_parser import InteractiveParser

from semtopo.errors import CrowdedQuestionError, InvalidQuestionError
from semtopo.expectations import A_MARK, EXAMPLES, closest_example, expectation
from semtopo.grammar import parser
from semtopo.questions import (
    AVOIDED_MAX,
    STOPS_MAX,
    ChangesQuestion,
    ClassesQuestion,
    ConnectionQuestion,
    DistanceQuestion,
    FrontiersQuestion,
    Goal,
    Here,
    HereQuestion,
    Leg,
    LocationQuestion,
    Named,
    Nearest,
    NearestQuestion,
    NeighboursQuestion,
    PathQuestion,
    Place,
    Question,
    ReachableQuestion,
    ReachingQuestion,
    SeenQuestion,
    ZonesQuestion,
)

FINAL_MARKS = " \t\n\r\f\v\u00a0\u3000.?!\u2026\u3002\uff01\uff1f"
"""What may follow the last word of a sentence."""

OPENING_MARKS = '"“„«\u2018'
"""What a quotation begins with; a straight single mark may be a part of a name too."""

_ARTICLES = {"the", "a", "an"}

_PRIVATE = 0xF0000
"""Unicode's plane 15 is for private use: no name holds characters of it, and no rule knows them."""

_PRIVATE_SIZE = 0xFFFE

_Trip: TypeAlias = tuple[Place, tuple[Leg, ...]]


def bound(text: str, start: int, stop: int) -> str:
    """Return a sentence, as long as before, in which a stretch is one name whatever its words."""
    codes = [ord(character) for character in text[start:stop]]
    inner = "".join(chr(code + _PRIVATE if code < _PRIVATE_SIZE else code) for code in codes)
    return text[:start] + inner + text[stop:]


def _loosened(name: str) -> str:
    """Return a name as it was before it was bound."""
    codes = [ord(character) for character in name]
    private = range(_PRIVATE, _PRIVATE + _PRIVATE_SIZE)
    return "".join(chr(code - _PRIVATE if code in private else code) for code in codes)


def prepare() -> None:
    """Make the parser ready for questions of every kind, so that the first need not wait for it."""
    for example in EXAMPLES.values():
        parse(example)


def parse(text: str) -> Question:
    """Return what a sentence asks.

    Raises
    ------
    InvalidQuestionError
        It leaves the grammar.
    CrowdedQuestionError
        It names more zones than one question may.
    """
    said = text.rstrip(FINAL_MARKS)
    states = parser().parse_interactive(said)
    begun: list[str] = []
    try:
        begun += (token.type for token in states.iter_parse())
        tree = states.feed_eof()  # type: ignore[no-untyped-call]  # of lark
    except (UnexpectedToken, UnexpectedCharacters) as error:
        position = _end(error, said)
        is_quotation = position < len(said) and said[position] in OPENING_MARKS
        expected = A_MARK if is_quotation else _expected(states)
        raise InvalidQuestionError(*_refusal(said, position, expected, begun)) from None
    question: Question = _value(tree)
    _refuse_crowds(said, question)
    return question


def _expected(states: InteractiveParser) -> str:
    return expectation(states.accepts())  # type: ignore[no-untyped-call]  # of lark


def _end(error: UnexpectedToken | UnexpectedCharacters, said: str) -> int:
    """Return where a sentence leaves the grammar, in characters from 0."""
    if isinstance(error, UnexpectedToken):
        return len(said) if error.token.type == "$END" else error.token.start_pos or 0
    return error.pos_in_stream  # type: ignore[return-value]  # lark says None, and sets it


def _refusal(
    said: str, position: int, expected: str, begun: Sequence[str]
) -> tuple[str, int, str, str]:
    """Say what is missing, with an example of the question that was begun, or is most like it."""
    begin = next((terminal for terminal in begun if terminal in EXAMPLES), None)
    example = closest_example(said) if begin is None else EXAMPLES[begin]
    where = "at the end" if position >= len(said) else f"at character {position + 1}"
    message = f'Expected {expected} {where}; ask, for example, "{example}".'
    return message, position, expected, example


def _refuse_crowds(said: str, question: Question) -> None:
    """Raise CrowdedQuestionError where a question names more zones than one may."""
    if not isinstance(question, PathQuestion | ConnectionQuestion):
        return
    stops = [_position(stop) for leg in question.legs for stop in (leg.goal, *leg.via)]
    avoided = [_position(name) for leg in question.legs for name in leg.avoiding]
    for positions, most, what in (
        (stops, STOPS_MAX, "to go to or through"),
        (avoided, AVOIDED_MAX, "to avoid"),
    ):
        if len(positions) > most:
            expected = f"at most {most} zones {what}"
            place = sorted(positions)[most]
            raise CrowdedQuestionError(*_refusal(said, place, expected, ["_WAY"]))


def _position(goal: Goal) -> int:
    """Return where a goal is named; the robot's place is nowhere, so it counts as first."""
    match goal:
        case Nearest(Named(_, position)) | Named(_, position):
            return position
        case Here():
            return 0


def _value(part: object) -> Any:  # noqa: ANN401 -- each rule of the grammar has its own
    """Return what a part of a sentence means."""
    if not isinstance(part, Tree):
        return part
    return _MEANINGS[part.data](*map(_value, part.children))


def _bare(*tokens: Token) -> Named:
    spoken = tokens[1:] if len(tokens) > 1 and tokens[0].lower() in _ARTICLES else tokens
    return Named(_loosened(" ".join(spoken)), spoken[0].start_pos or 0)


def _quoted(token: Token) -> Named:
    inner = token[1:-1].replace('""', '"') if token[0] == '"' else token[1:-1]
    return Named(inner.strip(), token.start_pos or 0)


def _all(*parts: object) -> tuple[object, ...]:
    return parts


def _leg(goal: Goal, *clauses: tuple[str, tuple[Named, ...]]) -> Leg:
    via, avoiding = (
        tuple(name for kind, names in clauses if kind == word for name in names)
        for word in ("via", "avoiding")
    )
    return Leg(goal, via, avoiding)


def _trip(ends: tuple[Place, Goal], *rest: Any) -> _Trip:  # noqa: ANN401 -- clauses, then legs
    clauses = [part for part in rest if not isinstance(part, Leg)]
    later = [part for part in rest if isinstance(part, Leg)]
    return (ends[0], (_leg(ends[1], *clauses), *later))


_MEANINGS: dict[str, Callable[..., Any]] = {
    "start": lambda question: question,
    "words": _bare,
    "quoted": _quoted,
    "names": _all,
    "number": int,
    "here": Here,
    "nearest": Nearest,
    "via": partial(_all, "via"),
    "avoiding": partial(_all, "avoiding"),
    "leg": _leg,
    "onwards": _all,
    "backwards": lambda goal, start: (start or Here(), goal),
    "trip": _trip,
    "path": lambda trip: PathQuestion(*trip),
    "connection": lambda trip: ConnectionQuestion(*trip),
    "reachability": lambda goal, start: ConnectionQuestion(start, (Leg(goal),)),
    "distance": lambda ends: DistanceQuestion(*ends),
    "remoteness": lambda goal, start: DistanceQuestion(start or Here(), goal),
    "nearest_zone": lambda zone_class, start: NearestQuestion(zone_class, start or Here()),
    "position": HereQuestion,
    "location": LocationQuestion,
    "neighbours": NeighboursQuestion,
    "reachable": ReachableQuestion,
    "reaching": ReachingQuestion,
    "seen": SeenQuestion,
    "changes": ChangesQuestion,
    "zones": ZonesQuestion,
    "classes": ClassesQuestion,
    "frontiers": FrontiersQuestion,
}
"""What each rule of the grammar makes of its parts."""
