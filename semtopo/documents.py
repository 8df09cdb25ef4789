"""Worlds, sensors, options, poses and scans as they are written in JSON, by file or over HTTP.

In come bytes or parsed JSON; out come the values of the other rooms, by `value()`. Everything has a
bound, so that no document can exhaust a machine; numbers are finite, and labels are clean words.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Annotated, Literal, Self

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    FailFast,
    Field,
    model_validator,
)

from semtopo.errors import InvalidWorldError
from semtopo.runs import LabelledRuns
from semtopo.sensor import Sensor
from semtopo.types import Edges, Identity, Kind, MappingOptions, Passages, Pose, Sensing
from semtopo.world import World, WorldZone

COORDINATE_MAX = 1e6  # m; a float still resolves 1e-10 m there
RANGE_MAX = 1e4  # m; no sensor indoors sees further
LABEL_LENGTH_MAX = 100
ZONES_MAX = 100_000
BEAMS_MAX = 4_000
SAMPLES_MAX = 2_000  # on one beam
SAMPLES_IN_ALL_MAX = 100_000
RUNS_MAX = 1_000  # on one beam
RUNS_IN_ALL_MAX = 20_000
LABELS_MAX = 1_000  # in one scan
MEMBERS_MAX = 64  # of a JSON object


@lru_cache(2**12)  # a robot sends the same few labels over and over
def _printable(text: str) -> str:
    """Refuse control characters, lone surrogates and spaces at the ends."""
    if text != text.strip() or not text.replace(" ", "x").isprintable():
        raise ValueError("a name holds only printable characters, and no space at its ends")
    return text


Label = Annotated[
    str, Field(strict=True, min_length=1, max_length=LABEL_LENGTH_MAX), AfterValidator(_printable)
]
Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Coordinate = Annotated[Number, Field(ge=-COORDINATE_MAX, le=COORDINATE_MAX)]
Angle = Annotated[Number, Field(ge=-1e3, le=1e3)]  # rad; more turns than this are a mistake
Radius = Annotated[Number, Field(gt=0, le=RANGE_MAX)]
KindName = Literal["space", "passage", "obstacle", "unknown"]

_KINDS = {kind.name.lower(): kind for kind in Kind}


class Document(BaseModel):
    """A JSON object that may hold nothing but its fields."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    @model_validator(mode="before")
    @classmethod
    def _is_small(cls, given: object) -> object:
        """Refuse a crowd of members at once; each would else become a fault of its own."""
        if isinstance(given, dict) and len(given) > MEMBERS_MAX:
            raise ValueError(f"an object has at most {MEMBERS_MAX} members")
        return given


class WorldZoneDocument(Document):
    """A labelled rectangle; corners in m, map frame."""

    label: Label
    kind: KindName
    low: tuple[Coordinate, Coordinate]
    high: tuple[Coordinate, Coordinate]

    def value(self) -> WorldZone:
        """Return the rectangle."""
        return WorldZone(self.label, _KINDS[self.kind], self.low, self.high)


class WorldDocument(Document):
    """A world of rectangles, later ones on top (R4)."""

    name: Annotated[str, Field(max_length=LABEL_LENGTH_MAX), AfterValidator(_printable)] = ""
    zones: Annotated[list[WorldZoneDocument], FailFast(), Field(min_length=1, max_length=ZONES_MAX)]

    def value(self) -> World:
        """Return the world; an error has the number of the zone, from 0."""
        zones = []
        for number, zone in enumerate(self.zones):
            try:
                zones.append(zone.value())
            except InvalidWorldError as error:
                raise InvalidWorldError(f"zones.{number}: {error}") from None
        return World(zones, name=self.name)


class SensorDocument(Document):
    """A simulated sensor; range in m. The defaults are the paper's."""

    beams: Annotated[int, Field(strict=True, ge=1, le=BEAMS_MAX)] = 72
    range: Radius = 2.0
    samples: Annotated[int, Field(strict=True, ge=2, le=SAMPLES_MAX)] = 20

    @model_validator(mode="after")
    def _can_be_borne(self) -> Self:
        """Refuse more samples in all than a step should take."""
        if self.beams * self.samples > SAMPLES_IN_ALL_MAX:
            raise ValueError(f"a sensor takes at most {SAMPLES_IN_ALL_MAX} samples in all")
        return self

    def value(self) -> Sensor:
        """Return the sensor."""
        return Sensor(self.beams, self.range, self.samples)


class MappingDocument(Document):
    """How a session maps; the defaults are the paper's behaviour. `min_zone_area` in m^2."""

    edges: Literal["seen", "adjacent"] = "seen"
    passages: Literal["first", "all"] = "first"
    identity: Literal["label", "instance"] = "label"
    sensing: Literal["sampled", "exact"] = "sampled"
    min_zone_area: Annotated[Number, Field(ge=0, le=COORDINATE_MAX)] = 0.0
    tolerance: Annotated[Number, Field(ge=0, le=COORDINATE_MAX)] = 0.0

    def value(self) -> MappingOptions:
        """Return the options."""
        return MappingOptions(
            edges=Edges(self.edges),
            passages=Passages(self.passages),
            identity=Identity(self.identity),
            sensing=Sensing(self.sensing),
            min_zone_area=self.min_zone_area,
            tolerance=self.tolerance,
        )


class PoseDocument(Document):
    """A pose: x, y in m, map frame; theta in rad, counter-clockwise from +x."""

    x: Coordinate
    y: Coordinate
    theta: Angle = 0.0

    def value(self) -> Pose:
        """Return the pose."""
        return Pose(self.x, self.y, self.theta)


Run = tuple[Label, Radius]
"""A label met on a beam, and the distance in m where it ends."""


def _few_runs(given: object) -> object:
    """Refuse too many runs in all, before each is looked at."""
    if isinstance(given, list) and len(given) <= BEAMS_MAX:
        count = sum(len(beam) for beam in given if isinstance(beam, list))
        if count > RUNS_IN_ALL_MAX:
            raise ValueError(f"a scan has at most {RUNS_IN_ALL_MAX} runs in all")
    return given


def _few_labels(beams: list[list[Run]]) -> list[list[Run]]:
    if len({label for beam in beams for label, _ in beam}) > LABELS_MAX:
        raise ValueError(f"a scan has at most {LABELS_MAX} labels")
    return beams


def _few_kinds(given: object) -> object:
    if isinstance(given, dict) and len(given) > LABELS_MAX:
        raise ValueError(f"a scan has at most {LABELS_MAX} kinds")
    return given


def _sorted(kinds: dict[Label, KindName]) -> dict[Label, KindName]:
    """Return the kinds in the order of their labels, so that equal scans are written alike."""
    return dict(sorted(kinds.items()))


class ScanDocument(Document):
    """Labelled runs along the beams of a real sensor, from the robot outwards.

    Beam i looks along theta + angle_min + i * angle_increment (rad). A beam whose last radius is
    below range_max (m) ended at an obstacle. Labels without an entry in `kinds` are spaces.
    """

    angle_min: Angle
    angle_increment: Angle
    range_max: Radius
    beams: Annotated[
        list[Annotated[list[Run], FailFast(), Field(max_length=RUNS_MAX)]],
        FailFast(),
        Field(max_length=BEAMS_MAX),
        BeforeValidator(_few_runs),
        AfterValidator(_few_labels),
    ]
    kinds: Annotated[
        dict[Label, KindName],
        Field(max_length=LABELS_MAX),
        BeforeValidator(_few_kinds),
        AfterValidator(_sorted),
    ] = {}

    def value(self) -> LabelledRuns:
        """Return the runs."""
        return LabelledRuns(
            angle_min=self.angle_min,
            angle_increment=self.angle_increment,
            range_max=self.range_max,
            beams=self.beams,
            kinds={label: _KINDS[kind] for label, kind in self.kinds.items()},
        )


class RecordedScan(Document):
    """One line of a recording: a pose, and what was seen from it. `k` and `t` are not used."""

    k: int | None = None
    t: Number | None = None
    pose: PoseDocument
    scan: ScanDocument
