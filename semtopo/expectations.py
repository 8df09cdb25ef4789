"""What a sentence may go on with, in plain words, for those whose sentence does not."""

from __future__ import annotations

from collections.abc import Iterable

A_QUESTION = 'a question such as "path from corridor to C", "where am I" or "list zones"'

AN_END = "the end of the question"

_WORDS_READ = 12

A_MARK = "the mark that ends the quotation"

WORDS = {
    "WORD": "a name",
    "_HERE": '"here"',
    "_NEAREST": '"the nearest"',
    "NUMBER": "the number of a step",
    "_TO": '"to"',
    "_FROM": '"from"',
    "_BETWEEN": '"between"',
    "_AND": '"and"',
    "_IN": '"in"',
    "_AT": '"at step"',
    "_SINCE": '"since step"',
    "_VIA": '"via"',
    "_AVOIDING": '"avoiding"',
    "_THEN": '"and then to"',
    "_OF_CLASS": '"of class"',
    "_REACHED": '"reachable" or "be reached"',
    "$END": AN_END,
}
"""What stands for each terminal of the grammar, in the order in which they are named.

The others are the first words of questions, or come along with one of these.
"""

EXAMPLES = {
    "_WAY": "path from corridor to C",
    "_IS_THERE": "is there a way from corridor to C",
    "_IS": "is C reachable from corridor",
    "_HOW_FAR": "how far is C from corridor",
    "_NEAREST": "nearest office from corridor",
    "_WHERE_AM_I": "where am I",
    "_WHERE_IS": "where is C",
    "_NEXT_TO": "what is next to C",
    "_REACHABLE_FROM": "which zones are reachable from C",
    "_LEADS_TO": "which zones lead to C",
    "_FROM_WHICH": "from which zones can C be reached",
    "_SEEN": "what did I see at step 5",
    "_CHANGED": "what changed between step 5 and 29",
    "_LIST_ZONES": "list zones of class office",
    "_LIST_CLASSES": "list classes",
    "_UNEXPLORED": "what is unexplored in C",
}
"""A question for each terminal that one may begin with."""


def expectation(terminals: Iterable[str]) -> str:
    """Say what could have stood in a place, given the terminals that the grammar takes there."""
    accepted = set(terminals)
    if "_WHERE_AM_I" in accepted:  # only at the beginning
        return A_QUESTION
    named = [words for terminal, words in WORDS.items() if terminal in accepted]
    return f"{', '.join(named[:-1])} or {named[-1]}" if len(named) > 1 else named[0]


def closest_example(said: str) -> str:
    """Return the example that has most words in common with the first words of a sentence."""
    words = set(said.casefold().split(maxsplit=_WORDS_READ)[:_WORDS_READ])
    return max(EXAMPLES.values(), key=lambda example: len(words & set(example.casefold().split())))
