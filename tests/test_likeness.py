"""The closest names are those of the plain definition, compared one by one."""

from __future__ import annotations

from itertools import pairwise

from hypothesis import given
from hypothesis import strategies as st

from semtopo.likeness import LIKENESS_MIN, NameLikeness

names = st.lists(st.text(st.sampled_from("abc -é厨"), min_size=1, max_size=8), unique=True)


def likeness(one: str, other: str) -> float:
    def pairs(name: str) -> set[tuple[str, str]]:
        marked = ["", *name, ""]
        return set(pairwise(marked))

    return 2 * len(pairs(one) & pairs(other)) / (len(pairs(one)) + len(pairs(other)))


@given(names, st.text(st.sampled_from("abc -é厨"), max_size=10))
def test_the_closest_are_the_likest(known: list[str], wanted: str) -> None:
    by_likeness = sorted(known, key=lambda name: -likeness(name, wanted))
    like = [name for name in by_likeness if likeness(name, wanted) >= LIKENESS_MIN]
    found = NameLikeness({name: name for name in known}).closest(wanted, 5)
    assert list(found) == like[:5]


def test_the_likest_of_very_many_is_found() -> None:
    crowd = {f"room {number}": f"room {number}" for number in range(5_000)}
    found = NameLikeness({**crowd, "kitchen": "kitchen"})
    assert found.closest("kitchn", 5) == ("kitchen",)
    assert found.closest("room 4998x", 1) == ("room 4998",)
    assert found.closest("rom 77", 1) == ("room 77",)


def test_odd_names_do_no_harm() -> None:
    assert NameLikeness({}).closest("a", 5) == ()
    known = NameLikeness({name: name for name in ("a\nb", "\ud800", "a" * 100)})
    assert known.closest("\n" * 2_000, 5) == ()
    assert known.closest("\ud800", 5) == ("\ud800",)
    assert known.closest("a" * 2_000, 5) == ("a" * 100,)
