"""The bare library, driven with the same JSON as the service; and that JSON for drawn values."""

from __future__ import annotations

import csv
import json
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from semtopo.codec import graph_body, step_document, zones_body
from semtopo.documents import (
    MappingDocument,
    PoseDocument,
    ScanDocument,
    SensorDocument,
    WorldDocument,
)
from semtopo.mapper import MapState, scan_world, step
from semtopo.runs import LabelledRuns, from_runs
from semtopo.sensor import Sensor
from semtopo.types import MappingOptions, Pose
from semtopo.world import World
from tests.servers import Json, Server

ROOT = Path(__file__).parents[2]
PAPER = ROOT / "examples" / "paper"


def paper_world() -> Json:
    """Return the world of the paper's run."""
    world: Json = json.loads((PAPER / "world.json").read_text())
    return world


def paper_steps() -> list[Json]:
    """Return the 81 steps of the paper's run."""
    with (PAPER / "path.csv").open(newline="") as lines:
        return [at(float(row["x"]), float(row["y"])) for row in csv.DictReader(lines)]


def at(x: float, y: float, theta: float = 0.0, scan: Json | None = None) -> Json:
    """Return the body of a step."""
    pose = {"x": x, "y": y, "theta": theta}
    return {"pose": pose} if scan is None else {"pose": pose, "scan": scan}


def paper_session(server: Server, count: int = 81) -> str:
    """Return the path of a new session that has taken the first steps of the paper's run."""
    path = server.create(world=paper_world())
    for document in paper_steps()[:count]:
        server.step(path, document)
    return path


def world_json(world: World) -> Json:
    """Return a world as its document."""
    zones = [
        {
            "label": zone.label,
            "kind": zone.kind.name.lower(),
            "low": list(zone.low),
            "high": list(zone.high),
        }
        for zone in world.zones
    ]
    return {"name": world.name, "zones": zones}


def sensor_json(sensor: Sensor) -> Json:
    """Return a sensor as its document."""
    return {"beams": sensor.beams, "range": sensor.range, "samples": sensor.samples}


def options_json(options: MappingOptions) -> Json:
    """Return mapping options as their document."""
    words = ("edges", "passages", "identity", "sensing")
    chosen: Json = {name: str(getattr(options, name)) for name in words}
    return {**chosen, "min_zone_area": options.min_zone_area, "tolerance": options.tolerance}


def scan_json(seen: LabelledRuns) -> Json:
    """Return a scan as its document."""
    return {
        "angle_min": seen.angle_min,
        "angle_increment": seen.angle_increment,
        "range_max": seen.range_max,
        "beams": [[list(run) for run in beam] for beam in seen.beams],
        "kinds": {label: kind.name.lower() for label, kind in seen.kinds.items()},
    }


def scan_step(pose: Pose, seen: LabelledRuns) -> Json:
    """Return the body of a step with a scan."""
    return at(pose.x, pose.y, pose.theta, scan_json(seen))


@dataclass
class Twin:
    """What a session of the service should be: all its states, and what each step answered.

    `session` is the body that the service's session was begun with.
    """

    session: Json
    states: list[MapState] = field(default_factory=lambda: [MapState()])
    answers: list[Json] = field(default_factory=list)

    @classmethod
    def driven(cls, session: Json, steps: Iterable[Json]) -> Twin:
        """Return a twin that has taken some steps."""
        twin = cls(session)
        for document in steps:
            twin.step(document)
        return twin

    @property
    def seq(self) -> int:
        """The last step."""
        return len(self.states) - 1

    def step(self, document: Json) -> Json:
        """Take a step, and return its answer, but for the time that it took."""
        pose = PoseDocument.model_validate(document["pose"]).value()
        options = MappingDocument.model_validate(self.session.get("mapping", {})).value()
        if "scan" in document:
            scan = from_runs(pose, ScanDocument.model_validate(document["scan"]).value())
        else:
            world = WorldDocument.model_validate(self.session["world"]).value()
            sensor = SensorDocument.model_validate(self.session.get("sensor", {})).value()
            scan = scan_world(world, sensor, pose.position, sensing=options.sensing)
        taken = step(self.states[-1], scan, options)
        self.states.append(taken.state)
        self.answers.append(plain(step_document(taken)))
        return self.answers[-1]

    def graph(self, seq: int | None = None) -> bytes:
        """Return the body of the graph as of a step; of the last one if none is named."""
        state = self.states[self.seq if seq is None else seq]
        return graph_body(state.graph, state.seq)

    def zones(self, seq: int | None = None) -> bytes:
        """Return the body of the zones as of a step; of the last one if none is named."""
        return zones_body(self.states[self.seq if seq is None else seq])


def plain(document: dict[str, Any]) -> Json:
    """Return a document as it looks after a journey through JSON."""
    back: Json = json.loads(json.dumps(document))
    return back


def untimed(answer: Json) -> Json:
    """Return the answer to a step without the time that it took."""
    return {key: value for key, value in answer.items() if key != "timings_ms"}
