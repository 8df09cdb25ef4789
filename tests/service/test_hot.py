"""Sessions in memory: what they weigh, and how long their steps may take."""

from __future__ import annotations

from semtopo import MappingOptions, MapState, Sensor, World, WorldDocument, explore
from semtopo.geometry import count_vertices
from service.hot import HotSession
from service.store import SessionRow
from tests.service.twin import paper_steps, paper_world

ROW = SessionRow(
    number=1, id="s", name="s", created_at="", version=0, owner=None, world=None, sensor="",
    mapping="", engine="", revision=0, checkpoint_every=32,
)  # fmt: skip


def hot(world: World | None = None, sensor: Sensor | None = None) -> HotSession:
    return HotSession(ROW, world, sensor or Sensor(), MappingOptions(), MapState())


def test_the_weight_of_a_map_follows_its_steps() -> None:
    world = WorldDocument.model_validate(paper_world()).value()
    positions = [(step["pose"]["x"], step["pose"]["y"]) for step in paper_steps()]
    session = hot(world)
    for step in explore(world, Sensor(), positions):
        session = session.after(step.state, 1.0)
    metric = session.state.metric
    points = sum(len(zone.border.xy) for zone in metric.zones.values())
    points += sum(count_vertices(door.region) for door in metric.doorways.values())
    things = len(metric.zones) + len(metric.doorways)
    assert 20 * points < session.map_bytes < 60 * points + 2_500 * things
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
