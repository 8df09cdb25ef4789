"""Which question a sentence asks of a certain map.

The grammar takes its own words first: "path from way to go to b" begins at `way`. Where the map
knows a name that holds such words, as `way to go`, the sentence may also be read with this name as
one. What names the map knows decides between the readings; where it knows those of several, the
sentence is ambiguous, and nobody guesses. A bare `here` is always where the robot is.
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
from semtopo.names import is_known
from semtopo.phrases import listed, phrase
from semtopo.questions import Named, Question
from semtopo.reading import FINAL_MARKS, OPENING_MARKS, bound, parse

_SPANS_MAX = 6
"""Names with words of the grammar in one sentence that are tried; each costs a reading."""

_NAME_WORDS_MAX = 8
"""Longer names are read in quotation marks only, if they hold words of the grammar."""

_MARKS = FINAL_MARKS + OPENING_MARKS + ","


def understand(atlas: Atlas, text: str) -> Question:
    """Return what a sentence asks.

    Raises
    ------
    InvalidQuestionError
        It leaves the grammar, however it is read.
    AmbiguousQuestionError
        It asks different things, as it is read.
    """
    readings: list[Question] = []
    for said in _bound_in_turn(atlas, text):
        with suppress(InvalidQuestionError):
            question = parse(said)
            if question not in readings and _is_about(atlas, question):
                readings.append(question)
    if len(readings) > 1:
        meanings = tuple(map(phrase, readings))
        message = f"This may mean {listed(meanings, 'or')}; put names in quotation marks."
        raise AmbiguousQuestionError(message, meanings)
    return readings[0] if readings else parse(text)


def _bound_in_turn(atlas: Atlas, text: str) -> Iterator[str]:
    """Yield a sentence as it is, then with names in it bound that it may else be read through.

    First each alone, then all together, as far as they do not overlap.
    """
    yield text
    spans = list(islice(_spans(atlas, text), _SPANS_MAX))
    yield from (bound(text, *span) for span in spans)
    if len(spans) > 1:
        end = 0
        for start, stop in spans:
            if start >= end:
                text, end = bound(text, start, stop), stop
        yield text


def _spans(atlas: Atlas, text: str) -> Iterator[tuple[int, int]]:
    """Yield where known names stand that may be misread, from left to right, the longest first."""
    words = [(word.start(), word.end()) for word in re.finditer(r"\S+", text)]
    for number, (start, _) in enumerate(words):
        for _, stop in reversed(words[number : number + _NAME_WORDS_MAX]):
            for end in sorted({stop, start + len(text[start:stop].rstrip(_MARKS))}, reverse=True):
                said = " ".join(text[start:end].split())
                if _may_be_misread(said) and is_known(atlas, said):
                    yield start, end


def _may_be_misread(name: str) -> bool:
    """Say whether a name holds words or marks of the grammar; a single word stands for itself."""
    words = name.casefold().replace(",", " ").split()
    has_words = len(words) > 1 and not reserved_words().isdisjoint(words)
    return has_words or name.strip(_MARKS) != name or "," in name


def _is_about(atlas: Atlas, part: object) -> bool:
    """Say whether the map knows all names in a question."""
    match part:
        case Named(name):
            return is_known(atlas, name)
        case tuple():
            return all(_is_about(atlas, one) for one in part)
        case _ if is_dataclass(part):
            return all(_is_about(atlas, getattr(part, one.name)) for one in fields(part))
        case _:
            return True
