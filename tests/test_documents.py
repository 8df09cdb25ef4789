"""Documents: everything has a bound, numbers are finite, labels are clean words."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from semtopo.documents import (
    BEAMS_MAX,
    COORDINATE_MAX,
    LABEL_LENGTH_MAX,
    LABELS_MAX,
    RANGE_MAX,
    RUNS_IN_ALL_MAX,
    RUNS_MAX,
    SAMPLES_IN_ALL_MAX,
    SAMPLES_MAX,
    Document,
    MappingDocument,
    PoseDocument,
    RecordedScan,
    ScanDocument,
    SensorDocument,
    WorldDocument,
    WorldZoneDocument,
)
from semtopo.errors import InvalidScanError, InvalidWorldError
from semtopo.runs import LabelledRuns
from semtopo.sensor import Sensor
from semtopo.types import Edges, Kind, MappingOptions, Pose
from semtopo.world import WorldZone
from tests.strategies import labelled_runs

POSE = {"x": 1.5, "y": -2, "theta": 0.25}
ZONE = {"label": "a", "kind": "space", "low": [0, 0], "high": [1, 2.5]}
WORLD = {"name": "w", "zones": [ZONE]}
SCAN = {
    "angle_min": 0, "angle_increment": 0.5, "range_max": 4,
    "beams": [[["a", 1], ["b", 2.5]], []], "kinds": {"a": "passage"},
}  # fmt: skip


def read(kind: type[Document], document: object) -> Any:  # noqa: ANN401 -- as many types as documents
    """Read a document as files and the service do: from JSON."""
    return kind.model_validate_json(json.dumps(document))


def bad(kind: type[Document], document: Mapping[str, object], **changed: object) -> None:
    """See that a good document is refused when a field has another value."""
    read(kind, document)
    with pytest.raises(ValidationError):
        read(kind, {**document, **changed})


def test_documents_become_values() -> None:
    assert read(PoseDocument, POSE).value() == Pose(1.5, -2.0, 0.25)
    assert read(PoseDocument, {"x": 0, "y": 0}).value() == Pose(0.0, 0.0, 0.0)
    assert read(SensorDocument, {}).value() == Sensor(72, 2.0, 20)
    assert read(MappingDocument, {}).value() == MappingOptions()
    assert read(
        MappingDocument, {"edges": "adjacent", "min_zone_area": 1}
    ).value() == MappingOptions(edges=Edges.ADJACENT, min_zone_area=1.0)
    world = read(WorldDocument, WORLD).value()
    assert (world.name, world.zones) == ("w", (WorldZone("a", Kind.SPACE, (0, 0), (1, 2.5)),))
    assert read(WorldDocument, {"zones": [ZONE]}).value().name == ""
    runs = read(ScanDocument, SCAN).value()
    assert runs.beams == [[("a", 1.0), ("b", 2.5)], []]
    assert runs.kinds == {"a": Kind.PASSAGE}
    recorded = read(RecordedScan, {"k": 7, "t": 12.5, "pose": POSE, "scan": SCAN})
    assert recorded.pose == read(PoseDocument, POSE)


@pytest.mark.parametrize("kind", Kind)
def test_every_kind_has_its_word(kind: Kind) -> None:
    assert read(WorldZoneDocument, ZONE | {"kind": kind.name.lower()}).value().kind is kind


@given(runs=labelled_runs())
def test_scans_read_back(runs: LabelledRuns) -> None:
    document = {
        "angle_min": runs.angle_min,
        "angle_increment": runs.angle_increment,
        "range_max": runs.range_max,
        "beams": [list(map(list, beam)) for beam in runs.beams],
        "kinds": {label: kind.name.lower() for label, kind in runs.kinds.items()},
    }
    assert read(ScanDocument, document).value() == runs


@given(st.floats(-COORDINATE_MAX, COORDINATE_MAX))
def test_numbers_read_back_to_the_bit(number: float) -> None:
    back = read(PoseDocument, {"x": number, "y": 0})
    again = PoseDocument.model_validate_json(back.model_dump_json())
    assert math.copysign(1, again.x) == math.copysign(1, number)
    assert again.x == number


NOT_NUMBERS = ["1", True, None, [], math.nan, math.inf, -math.inf]


@pytest.mark.parametrize("wrong", NOT_NUMBERS, ids=repr)
def test_what_is_no_number(wrong: object) -> None:
    for name in POSE:
        bad(PoseDocument, POSE, **{name: wrong})
    bad(WorldZoneDocument, ZONE, low=[0, wrong])
    bad(SensorDocument, {}, range=wrong)
    bad(SensorDocument, {}, beams=wrong)
    bad(MappingDocument, {}, min_zone_area=wrong)
    bad(ScanDocument, SCAN, beams=[[["a", wrong]]])
    for name in ("angle_min", "angle_increment", "range_max"):
        bad(ScanDocument, SCAN, **{name: wrong})


@pytest.mark.parametrize(
    ("kind", "document", "name", "least", "most"),
    [
        (PoseDocument, POSE, "x", -COORDINATE_MAX, COORDINATE_MAX),
        (PoseDocument, POSE, "theta", -1e3, 1e3),
        (SensorDocument, {}, "beams", 1, BEAMS_MAX),
        (SensorDocument, {"beams": 1}, "samples", 2, SAMPLES_MAX),
        (SensorDocument, {}, "range", 5e-324, RANGE_MAX),
        (MappingDocument, {}, "min_zone_area", 0, COORDINATE_MAX),
        (ScanDocument, SCAN, "range_max", 5e-324, RANGE_MAX),
        (ScanDocument, SCAN, "angle_min", -1e3, 1e3),
    ],
)  # fmt: skip
def test_numbers_have_bounds(
    kind: type[Document], document: dict[str, object], name: str, least: float, most: float
) -> None:
    for within in (least, most):
        assert getattr(read(kind, document | {name: within}), name) == within
    step = 1 if isinstance(least, int) and isinstance(most, int) else 1e-9 * most
    bad(kind, document, **{name: least - max(step, 1e-9)})
    bad(kind, document, **{name: most + step})


@pytest.mark.parametrize(
    "label", ["a", "Room 12", "Küche", "厨房", "🤖", "a" * LABEL_LENGTH_MAX, '"', "<&>", "a  b"]
)
def test_labels(label: str) -> None:
    assert read(WorldZoneDocument, ZONE | {"label": label}).label == label
    assert read(ScanDocument, SCAN | {"beams": [[[label, 1]]]}).beams == [[(label, 1.0)]]


@pytest.mark.parametrize(
    "label",
    ["", " ", " a", "a ", "a\n", "a\tb", "\0", "\x7f", "\x85", "\u00a0a", "\u200b", "\u2028",
     "\u202e", "\ud800", chr(0xDFFF), "\ufffe", "\U000e0001", "a" * (LABEL_LENGTH_MAX + 1), 1,
     None, ["a"], {}],
    ids=ascii,
)  # fmt: skip
def test_what_is_no_label(label: object) -> None:
    bad(WorldZoneDocument, ZONE, label=label)
    bad(ScanDocument, SCAN, beams=[[[label, 1]]])
    if isinstance(label, str):
        bad(ScanDocument, SCAN, kinds={label: "space"})
        if label:
            bad(WorldDocument, WORLD, name=label)


@pytest.mark.parametrize(
    ("kind", "document"),
    [(PoseDocument, POSE), (WorldZoneDocument, ZONE), (WorldDocument, WORLD), (SensorDocument, {}),
     (MappingDocument, {}), (ScanDocument, SCAN), (RecordedScan, {"pose": POSE, "scan": SCAN})],
)  # fmt: skip
def test_nothing_may_be_too_much_or_too_little(
    kind: type[Document], document: dict[str, object]
) -> None:
    bad(kind, document, more=1)
    needed = {name for name, field in kind.model_fields.items() if field.is_required()}
    for name in needed:
        with pytest.raises(ValidationError):
            read(kind, {key: value for key, value in document.items() if key != name})
    whole = read(kind, document)
    with pytest.raises(ValidationError):
        setattr(whole, next(iter(kind.model_fields)), 1)


@pytest.mark.parametrize("wrong", [[], [0], [0, 0, 0], {"x": 0, "y": 0}, 0, None], ids=repr)
def test_a_corner_has_two_numbers(wrong: object) -> None:
    bad(WorldZoneDocument, ZONE, low=wrong)


@pytest.mark.parametrize("low", [[1, 0], [0, 2.5], [2, 0], [0, 3], [1, 2.5]], ids=repr)
def test_a_zone_has_an_extent(low: list[float]) -> None:
    document = read(WorldDocument, {"zones": [ZONE | {"low": low}]})
    with pytest.raises(InvalidWorldError):
        document.value()


def test_a_world_has_a_zone_and_not_too_many() -> None:
    bad(WorldDocument, WORLD, zones=[])
    bad(WorldDocument, WORLD, zones=[ZONE] * 100_001)


def test_a_scan_has_bounds() -> None:
    read(ScanDocument, SCAN | {"beams": [[]] * BEAMS_MAX})
    bad(ScanDocument, SCAN, beams=[[]] * (BEAMS_MAX + 1))
    bad(ScanDocument, SCAN, beams=[[["a", n] for n in range(1, RUNS_MAX + 2)]])
    bad(ScanDocument, SCAN, kinds={f"k{n}": "space" for n in range(LABELS_MAX + 1)})
    bad(ScanDocument, SCAN, kinds={"a": "SPACE"})
    bad(ScanDocument, SCAN, beams=[[["a", 0]]])


def test_a_scan_has_bounds_in_all() -> None:
    def runs(count: int) -> list[list[tuple[str, int]]]:
        beam = [(name, radius) for radius, name in enumerate("ababcdef", start=1)]
        return [beam] * (count // 8) + [beam[: count % 8]]

    def labels(count: int) -> list[list[tuple[str, int]]]:
        return [[(f"l{number}", 1)] for number in range(count)]

    narrow = SCAN | {"angle_increment": 1e-4}
    read(ScanDocument, narrow | {"beams": runs(RUNS_IN_ALL_MAX)})
    bad(ScanDocument, narrow, beams=runs(RUNS_IN_ALL_MAX + 1))
    read(ScanDocument, narrow | {"beams": labels(LABELS_MAX)})
    bad(ScanDocument, narrow, beams=labels(LABELS_MAX + 1))


def test_a_sensor_has_a_bound_in_all() -> None:
    beams = SAMPLES_IN_ALL_MAX // 100
    read(SensorDocument, {"beams": beams, "samples": 100})
    bad(SensorDocument, {}, beams=beams + 1, samples=100)
    bad(SensorDocument, {}, beams=BEAMS_MAX, samples=SAMPLES_MAX)


def test_kinds_are_written_in_one_order() -> None:
    names = ["b", "a", "Ä", "c"]
    one, other = (
        read(ScanDocument, SCAN | {"kinds": dict.fromkeys(order, "passage")})
        for order in (names, reversed(names))
    )
    assert one.model_dump_json() == other.model_dump_json()


@pytest.mark.parametrize(
    "changed",
    [{"beams": [[["a", 2], ["b", 1]]]}, {"beams": [[["a", 5]]]}, {"beams": [[]] * 14},
     {"angle_increment": 0}],
    ids=["descending", "beyond range", "more than a turn", "all in one"],
)  # fmt: skip
def test_a_scan_makes_sense(changed: dict[str, object]) -> None:
    document = read(ScanDocument, SCAN | changed)
    with pytest.raises(InvalidScanError):
        document.value()


def test_a_crowd_of_wrong_things_is_not_listed() -> None:
    """A long list of mistakes would cost more time and memory than the document itself."""
    wrong: list[tuple[type[Document], object]] = [
        (ScanDocument, SCAN | {"beams": [0] * 4_000}),
        (ScanDocument, SCAN | {"beams": [[0] * 1_000]}),
        (WorldDocument, {"zones": [0] * 100_000}),
        (PoseDocument, POSE | {f"m{n}": 0 for n in range(100_000)}),
        (WorldDocument, {"zones": [ZONE | {f"m{n}": 0 for n in range(100_000)}]}),
        (ScanDocument, SCAN | {"kinds": {f"k{n}": 0 for n in range(100_000)}}),
    ]
    for kind, document in wrong:
        with pytest.raises(ValidationError) as caught:
            read(kind, document)
        assert caught.value.error_count() < 10
