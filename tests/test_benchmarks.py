"""The benchmarks run, on a small scale, and their peers do what they should."""

from __future__ import annotations

import shutil

import pytest

from benchmarks import growth, stages, worlds
from benchmarks.paper import path, wander
from semtopo import MappingOptions, Sensor, explore
from semtopo.types import Sensing


def test_table_1_has_every_stage_and_its_total(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stages, "ROUNDS", 1)
    runs = stages.timed_run(36, MappingOptions())
    assert list(runs) == [*stages.PAPER, "total"]
    assert all(len(times) == len(path()) for times in runs.values())
    assert sum(runs["total"]) == pytest.approx(sum(sum(runs[stage]) for stage in stages.PAPER))


@pytest.mark.skipif(shutil.which("cc") is None, reason="the floor needs a C compiler")
def test_the_floor_is_measured(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stages, "ROUNDS", 1)
    loop = stages.c_loop_ms(36)
    assert loop is not None
    assert 0 < loop < 50
    assert stages.union_ms(36, stages.MINIMAL) > 0


def test_growth_is_measured_on_the_same_walk(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(growth, "STEPS", 150)
    monkeypatch.setattr(growth, "MARKS", (100, 150))
    whole, reduced = growth.run(0.0), growth.run(0.02)
    assert len(whole[0]) == len(reduced[0]) == 150
    assert growth.vertices(reduced[1][150]) < growth.vertices(whole[1][150]) / 5
    assert 0 < growth.differing(reduced[1][150], whole[1][150], 0.02) < 1
    assert 100 < growth.grid_bytes(reduced[1][150]) < 10_000


def test_a_wandering_robot_stays_in_free_space() -> None:
    walk = wander(200)
    assert len(walk) == 200
    *_, last = explore(worlds.floor(10), Sensor(36), worlds.walk(worlds.floor(10)))
    assert len(last.state.metric.zones) >= 2


@pytest.mark.parametrize("sensing", Sensing)
def test_a_walk_through_a_large_world_is_timed(
    monkeypatch: pytest.MonkeyPatch, sensing: Sensing
) -> None:
    monkeypatch.setattr(worlds, "ROUNDS", 1)
    total, sensed = worlds.timed(worlds.floor(1_000), sensing)
    assert 0 < sensed < total
