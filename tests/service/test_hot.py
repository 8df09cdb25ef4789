"""What is kept in memory: the most recent, and not more than there is room for."""

from __future__ import annotations

from service.hot import Recent


def test_the_oldest_is_forgotten() -> None:
    kept: Recent[str, int] = Recent(2)
    for number, name in enumerate("abc"):
        kept.put(name, number)
    assert [kept.get(name) for name in "abc"] == [None, 1, 2]
    assert len(kept) == 2


def test_what_is_used_stays() -> None:
    kept: Recent[str, int] = Recent(2)
    kept.put("a", 1)
    kept.put("b", 2)
    assert kept.get("a") == 1
    kept.put("c", 3)
    assert [kept.get(name) for name in "abc"] == [1, None, 3]


def test_a_new_value_takes_the_place_of_the_old() -> None:
    kept: Recent[str, int] = Recent(2)
    kept.put("a", 1)
    kept.put("b", 2)
    kept.put("a", 3)
    kept.put("c", 4)
    assert [kept.get(name) for name in "abc"] == [3, None, 4]


def test_what_is_dropped_is_gone() -> None:
    kept: Recent[str, int] = Recent(2)
    kept.put("a", 1)
    kept.drop("a")
    kept.drop("b")
    assert kept.get("a") is None
    assert len(kept) == 0
