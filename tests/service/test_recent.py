"""What is kept in memory: the most recent, and not more than there is room for."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from service.recent import Recent


def recent(size: int = 9, weight_max: int = 99) -> Recent[str, int]:
    """Return an empty memory for numbers, which weigh what they are."""
    return Recent(size, weight_max, lambda number: number)


def test_the_oldest_is_forgotten() -> None:
    kept = recent(size=2)
    for number, name in enumerate("abc"):
        kept.put(name, number)
    assert [kept.get(name) for name in "abc"] == [None, 1, 2]
    assert len(kept) == 2


def test_what_is_used_stays() -> None:
    kept = recent(size=2)
    kept.put("a", 1)
    kept.put("b", 2)
    assert kept.get("a") == 1
    kept.put("c", 3)
    assert [kept.get(name) for name in "abc"] == [1, None, 3]


def test_a_new_value_takes_the_place_of_the_old() -> None:
    kept = recent(size=2)
    kept.put("a", 1)
    kept.put("b", 2)
    kept.put("a", 3)
    kept.put("c", 4)
    assert [kept.get(name) for name in "abc"] == [3, None, 4]


def test_what_is_dropped_is_gone() -> None:
    kept = recent(size=2)
    kept.put("a", 1)
    kept.drop("a")
    kept.drop("b")
    assert kept.get("a") is None
    assert (len(kept), kept.weight) == (0, 0)


def test_a_heavy_entry_drives_out_the_oldest() -> None:
    kept = recent(weight_max=10)
    for name, weight in (("a", 4), ("b", 4), ("c", 5)):
        kept.put(name, weight)
    assert [kept.get(name) for name in "abc"] == [None, 4, 5]
    kept.put("b", 6)  # it grew
    assert [kept.get(name) for name in "abc"] == [None, 6, None]


def test_the_last_entry_stays_however_heavy_it_is() -> None:
    kept = recent(weight_max=10)
    kept.put("a", 1)
    kept.put("b", 50)
    assert [kept.get(name) for name in "ab"] == [None, 50]


@given(
    st.lists(st.tuples(st.sampled_from("abcdef"), st.none() | st.integers(0, 30))),
    st.integers(1, 4),
    st.integers(0, 40),
)
def test_the_bounds_hold_and_the_weight_is_known(
    uses: list[tuple[str, int | None]], size: int, weight_max: int
) -> None:
    kept = recent(size, weight_max)
    for name, number in uses:
        if number is None:
            kept.drop(name)
        else:
            kept.put(name, number)
            assert kept.get(name) == number
        entries = [number for name in "abcdef" if (number := kept.get(name)) is not None]
        assert kept.weight == sum(entries)
        assert len(kept) == len(entries) <= size
        assert kept.weight <= weight_max or len(kept) == 1
