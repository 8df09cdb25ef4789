"""Which of many names are like a given one: for those who mistyped it.

Two names are as like as their sets of pairs of neighbouring characters, ends marked (Dice's
coefficient: twice what both have, divided by what each has).
"""

from __future__ import annotations

from collections.abc import Mapping
from heapq import nlargest

import numpy as np

from semtopo.types import Integers

LIKENESS_MIN = 0.4
"""Of 1; with less in common, hardly anybody would take one for the other."""

LENGTH_READ = 200
"""Characters of a given name that count; labels have half as many at most."""

_END = "\n"
_EXAMINED = 64  # the likest when pairs count as often as they occur, which costs less


class NameLikeness:
    """Known names, ready to be compared with others."""

    def __init__(self, names: Mapping[str, str]) -> None:
        """Take names with the forms in which they are compared."""
        self._names = list(names)
        self._forms = [form.replace(_END, " ") for form in names.values()]
        codes = _codes(_marked(_END.join(self._forms)) if self._forms else _END)
        self._owners: Integers = np.cumsum(codes[:-1] == ord(_END)) - 1
        self._pairs: Integers = _joined(codes)

    def closest(self, form: str, count: int) -> tuple[str, ...]:
        """Return up to `count` names that are like a form, the likest first, then as they came."""
        wanted = _marked(form[:LENGTH_READ].replace(_END, " "))
        common = self._in_common(wanted)
        sizes = np.array([len(known) + 1 for known in self._forms])
        rough = common / (sizes + len(wanted) - 1) if len(sizes) else common
        examined = np.argsort(-rough, kind="stable")[:_EXAMINED]
        likeness = {
            number: _likeness(_pairs(wanted), _pairs(_marked(self._forms[number])))
            for number in sorted(examined.tolist())
        }
        alike = [number for number, value in likeness.items() if value >= LIKENESS_MIN]
        return tuple(self._names[it] for it in nlargest(count, alike, key=likeness.__getitem__))

    def _in_common(self, wanted: str) -> Integers:
        """Return how many pairs of each name are among those wanted."""
        hits = np.isin(self._pairs, np.unique(_joined(_codes(wanted))))
        return np.bincount(self._owners[hits], minlength=len(self._names))


def _marked(form: str) -> str:
    """Return a form with its ends marked."""
    return f"{_END}{form}{_END}"


def _codes(text: str) -> Integers:
    encoded = text.encode("utf-32-le", errors="surrogatepass")
    return np.frombuffer(encoded, dtype="<u4").astype(np.intp)


def _joined(codes: Integers) -> Integers:
    """Return one number for each pair of neighbours."""
    return (codes[:-1] << 21) | codes[1:]  # no character has more than 21 bits


def _pairs(marked: str) -> set[str]:
    return {marked[at : at + 2] for at in range(len(marked) - 1)}


def _likeness(one: set[str], other: set[str]) -> float:
    return 2 * len(one & other) / (len(one) + len(other))
