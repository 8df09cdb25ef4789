"""Which question a sentence asks of a certain map.

The grammar takes its own words first: "path from way to go to b" begins at `way`. Where the map
knows a name that holds such words, as `way to go`, the sentence may also be read with this name as
one. What names the map knows decides between the readings; where it knows those of several, the
sentence is ambiguous, and nobody guesses. A bare `here` is always where the robot is.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields, is_dataclass

from semtopo.atlas import Atlas
from semtopo.errors import AmbiguousQuestionError, InvalidQuestionError
from semtopo.grammar import reserved_words
from semtopo.names import directory_of, folded
from semtopo.phrases import listed, phrase
from semtopo.questions import Named, Question
from semtopo.reading import FINAL_MARKS, OPENING_MARKS, bound, parse

_READINGS_MAX = 6
"""Names that are bound one by one in a sentence; each costs a reading."""

_WORDS_READ_MAX = 1_500
"""Words in all these readings of a sentence; so a long one has fewer."""

_NAME_WORDS_MAX = 8
"""Longer names are read in quotation marks only, if they hold words of the grammar."""

_MARKS = FINAL_MARKS + OPENING_MARKS + ","


@dataclass(frozen=True, slots=True)
class _Span:
    """Where a known name stands in a sentence."""

    start: int
    stop: int
    name: str


def understand(atlas: Atlas, text: str) -> Question:
    """Return what a sentence asks.

    Raises
    ------
    InvalidQuestionError
        It leaves the grammar, however it is read.
    AmbiguousQuestionError
        It asks different things, as it is read.
    """
    names = directory_of(atlas).folded_names
    as_it_is = _read(text)
    spoken = {(it.position, folded(it.name)) for it in _named(as_it_is)}
    spans = [it for it in _spans(text, names) if (it.start, it.name) not in spoken]
    readings = [as_it_is, *map(_read, _bound_in_turn(text, spans))]
    known = [it for it in readings if it and {folded(one.name) for one in _named(it)} <= names]
    if any(other != known[0] for other in known):
        meanings = tuple(dict.fromkeys(map(phrase, known)))
        message = f"This may mean {listed(meanings, 'or')}; put names in quotation marks."
        raise AmbiguousQuestionError(message, meanings)
    return known[0] if known else parse(text)


def _read(text: str) -> Question | None:
    """Return what a sentence asks, if anything."""
    try:
        return parse(text)
    except InvalidQuestionError:
        return None


def _bound_in_turn(text: str, spans: Sequence[_Span]) -> Iterator[str]:
    """Yield a sentence with some names bound: each alone, then all that do not overlap."""
    few = min(_READINGS_MAX, _WORDS_READ_MAX // max(1, len(text.split())))
    yield from (bound(text, span.start, span.stop) for span in spans[:few])
    if len(spans) > 1:
        end = 0
        for span in spans:
            if span.start >= end:
                text, end = bound(text, span.start, span.stop), span.stop
        yield text


def _spans(text: str, names: frozenset[str]) -> Iterator[_Span]:
    """Yield where known names stand that may be misread, from left to right, the longest first."""
    words = list(re.finditer(r"\S+", text))
    said = [folded(word[0]) for word in words]
    for number, word in enumerate(words):
        for stop in range(min(number + _NAME_WORDS_MAX, len(words)), number, -1):
            whole = " ".join(said[number:stop])
            for name in dict.fromkeys((whole, whole.rstrip(_MARKS))):
                if name in names and _may_be_misread(name):
                    marks = len(whole) - len(name)  # which folding leaves as they are
                    yield _Span(word.start(), words[stop - 1].end() - marks, name)


def _may_be_misread(name: str) -> bool:
    """Say whether a name holds words or marks of the grammar; a single word stands for itself."""
    words = name.replace(",", " ").split()
    has_words = len(words) > 1 and not reserved_words().isdisjoint(words)
    return has_words or name.strip(_MARKS) != name or "," in name


def _named(part: object) -> Iterator[Named]:
    """Yield the names in a question."""
    if isinstance(part, Named):
        yield part
    elif isinstance(part, tuple):
        yield from (name for one in part for name in _named(one))
    elif is_dataclass(part):
        yield from (name for one in fields(part) for name in _named(getattr(part, one.name)))
