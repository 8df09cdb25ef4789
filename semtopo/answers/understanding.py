"""Which question a sentence asks of a certain map.

The grammar takes its own words first: "path from way to go to b" begins at `way`. Where the map
knows a name that holds such words, as `way to go`, the sentence may also be read with this name as
one. What names the map knows decides between the readings; where it knows those of several, the
sentence is ambiguous, and nobody guesses.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import fields, is_dataclass
from itertools import islice

from semtopo.atlas import Atlas
from semtopo.errors import AmbiguousQuestionError, InvalidQuestionError
from semtopo.grammar import reserved_words
from semtopo.names import folded, known_names
from semtopo.phrases import listed, phrase
from semtopo.questions import Named, Question
from semtopo.reading import FINAL_MARKS, OPENING_MARKS, bound, parse

_WORD = re.compile(r"[^\s,]+")
_MARKS = frozenset(FINAL_MARKS) - {" "} | frozenset(OPENING_MARKS) | {","}

_SPANS_MAX = 6
"""Names with words of the grammar in one sentence that are tried; each costs a reading."""


def understand(atlas: Atlas, text: str) -> Question:
    """Return what a sentence asks.

    Raises
    ------
    InvalidQuestionError
        It leaves the grammar, however it is read.
    AmbiguousQuestionError
        It asks different things, as it is read.
    """
    names = frozenset(map(folded, known_names(atlas)))
    readings: list[Question] = []
    for said in _bound_in_turn(text, names):
        with suppress(InvalidQuestionError):
            question = parse(said)
            if question not in readings and _names_of(question) <= names:
                readings.append(question)
    if len(readings) > 1:
        meanings = tuple(map(phrase, readings))
        message = f"This may mean {listed(meanings, 'or')}; put names in quotation marks."
        raise AmbiguousQuestionError(message, meanings)
    return readings[0] if readings else parse(text)


def _bound_in_turn(text: str, names: frozenset[str]) -> Iterator[str]:
    """Yield a sentence as it is, then with names in it bound that it may else be read through.

    First each alone, then all together, as far as they do not overlap.
    """
    yield text
    spans = list(islice(_spans(text, names), _SPANS_MAX))
    yield from (bound(text, *span) for span in spans)
    if len(spans) > 1:
        end = 0
        for start, stop in spans:
            if start >= end:
                text, end = bound(text, start, stop), stop
        yield text


def _spans(text: str, names: frozenset[str]) -> Iterator[tuple[int, int]]:
    """Yield where names that may be misread stand in a sentence, the longest first."""
    known = _misreadable(names)
    words = list(_WORD.finditer(text))
    said = [folded(word[0]) for word in words]
    for number, first in enumerate(said):
        for parts in known.get(first.rstrip(FINAL_MARKS), ()):
            stop = number + len(parts)
            if said[number:stop] == parts:
                yield words[number].start(), words[stop - 1].end()
            elif [*said[number : stop - 1], said[-1].rstrip(FINAL_MARKS)] == parts:
                yield words[number].start(), len(text.rstrip(FINAL_MARKS))


def _misreadable(names: frozenset[str]) -> dict[str, list[list[str]]]:
    """Return the names with words or marks of the grammar, by their first word, as words."""
    found: dict[str, list[list[str]]] = {}
    for name in names:
        parts = _WORD.findall(name)
        if parts and not (reserved_words().isdisjoint(parts) and _MARKS.isdisjoint(name)):
            found.setdefault(parts[0].rstrip(FINAL_MARKS), []).append(parts)
    return {first: sorted(group, key=len, reverse=True) for first, group in found.items()}


def _names_of(part: object) -> set[str]:
    """Return the names in a question, folded."""
    match part:
        case Named(name):
            return {folded(name)}
        case tuple():
            return {name for one in part for name in _names_of(one)}
        case _ if is_dataclass(part):
            return {name for one in fields(part) for name in _names_of(getattr(part, one.name))}
        case _:
            return set()
