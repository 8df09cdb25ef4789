"""Read back what `semtopo map` wrote into a folder, so that it can be asked.

The zones and the graph are those of the last step; of earlier ones only findings are known, and
where the robot was.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import orjson

from semtopo.answers import History
from semtopo.atlas import Atlas
from semtopo.errors import InvalidMapError, UnknownStepError
from semtopo.exports.chart import Chart
from semtopo.exports.geojson import bordered, read_borders, read_doorways
from semtopo.mapper import MapState
from semtopo.readback import read_map
from service.mapping_run import BORDERS, DOORWAYS, GRAPH, STEPS, ZONES, naming


@dataclass(frozen=True, slots=True)
class Folder:
    """A map, and what is known of its earlier steps."""

    atlas: Atlas
    history: History


def read_folder(directory: Path) -> Folder:
    """Read a folder; without its steps, borders or doorways, the map alone.

    Raises
    ------
    InvalidMapError
        The files are none that `semtopo map` wrote.
    OSError
        A file cannot be read.
    """
    state = _read_state(directory)
    with suppress(FileNotFoundError):
        state = _with_doorways(state, directory / DOORWAYS)
    with suppress(FileNotFoundError), naming(directory / BORDERS):
        state = bordered(state, read_borders((directory / BORDERS).read_bytes()))
    steps = _read_steps(directory / STEPS)
    return Folder(Atlas(_placed(state, steps)), partial(_placed_at, state, steps))


def read_chart(directory: Path, radius: float) -> Chart:
    """Read what can be exported from a folder, for a robot of a radius; raises as `read_folder`."""
    state = _with_doorways(_read_state(directory), directory / DOORWAYS)
    with naming(directory / BORDERS):
        borders = read_borders((directory / BORDERS).read_bytes())
    return Chart(state, borders, radius)


def _read_state(directory: Path) -> MapState:
    return read_map((directory / ZONES).read_bytes(), (directory / GRAPH).read_bytes())


def _with_doorways(state: MapState, file: Path) -> MapState:
    with naming(file):
        doorways = read_doorways(file.read_bytes())
    return replace(state, metric=replace(state.metric, doorways=doorways))


def _read_steps(file: Path) -> list[dict[str, Any]]:
    """Return the answers of all steps, in order; none if the file is not there."""
    try:
        lines = file.read_bytes().splitlines()
    except FileNotFoundError:
        return []
    with naming(file):
        try:
            steps = [orjson.loads(line) for line in lines]
        except ValueError:
            raise InvalidMapError("a line is not JSON") from None
        if any(not isinstance(step, dict) or "here" not in step for step in steps):
            raise InvalidMapError("a line is no step")
        return steps


def _placed_at(state: MapState, steps: Sequence[dict[str, Any]], seq: int) -> MapState:
    """Return what is known of the map after a step: its graph, and where the robot was."""
    if not 0 < seq <= len(steps):
        raise UnknownStepError("The folder does not tell of that step.")
    return _placed(MapState(seq, graph=state.graph.at(seq)), steps)


def _placed(state: MapState, steps: Sequence[dict[str, Any]]) -> MapState:
    """Return a map with the zone where the robot was after its last step, as far as is known."""
    here = steps[state.seq - 1]["here"] if 0 < state.seq <= len(steps) else None
    return replace(state, here=here) if here in state.graph.nodes else state
