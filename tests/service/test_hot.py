"""What is kept in memory: the most recent, and not more than there is room for."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from semtopo import MappingOptions, MapState, Sensor, World, WorldDocument, explore
from service.hot import HotSession, Recent
from service.store import SessionRow
from tests.service.twin import paper_steps, paper_world


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


# What a session weighs

ROW = SessionRow(
    number=1, id="s", name="s", created_at="", version=0, owner=None, world=None, sensor="",
    mapping="", engine="",
)  # fmt: skip


def hot(world: World | None = None, sensor: Sensor | None = None) -> HotSession:
    return HotSession(ROW, world, sensor or Sensor(), MappingOptions(), MapState())


def test_the_weight_of_a_map_follows_its_steps() -> None:
    world = WorldDocument.model_validate(paper_world()).value()
    positions = [(step["pose"]["x"], step["pose"]["y"]) for step in paper_steps()]
    session = hot(world)
    for step in explore(world, Sensor(), positions):
        session = session.after(step.state, 1.0)
    zones = session.state.metric.zones.values()
    points = sum(len(zone.border.xy) for zone in zones)
    assert 20 * points < session.map_bytes < 60 * points + 2_000 * len(zones)
    afresh = hot(world).after(session.state, 1.0)
    assert afresh.map_bytes == session.map_bytes


def test_a_world_weighs_what_its_zones_do() -> None:
    document = WorldDocument.model_validate(paper_world())
    zones = document.zones * 100
    many = WorldDocument(zones=zones).value()
    assert hot(many).weight - hot().weight > 1_000 * len(zones)


def test_a_session_is_light_as_long_as_every_step_must_be_short() -> None:
    zones = WorldDocument.model_validate(paper_world()).zones
    few, many = (WorldDocument(zones=zones * times).value() for times in (10, 1_000))
    assert hot().is_light
    assert hot(few, Sensor(72, 2.0, 20)).is_light
    assert not hot(few, Sensor(360, 2.0, 100)).is_light
    assert not hot(many, Sensor(72, 2.0, 20)).is_light
