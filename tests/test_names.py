"""Names: which zones an id, a label, an alias or a class means."""

from __future__ import annotations

import unicodedata

import pytest
from hypothesis import given
from hypothesis import strategies as st

from semtopo.atlas import Atlas
from semtopo.errors import AmbiguousZoneError, UnknownZoneError
from semtopo.names import (
    NAMES_TOLD_MAX,
    closest_names,
    directory_of,
    resolve,
    resolve_class,
    resolve_one,
)
from semtopo.notes import ZoneNotes
from tests.atlases import atlas

OFFICE = atlas(
    (),
    ["corridor", "room-1", "room-2", "room-3", "lab#1", "lab#2", "Straße", "Ab", "aB"],
    labels={"lab#1": "lab", "lab#2": "lab"},
    notes={
        "room-2": ZoneNotes(("Anna's room", "library"), "office"),
        "room-1": ZoneNotes((), "office"),
        "room-3": ZoneNotes(("Café",), "Lab"),
        "gone": ZoneNotes(("nowhere",), "office"),
    },
)


@pytest.mark.parametrize(
    ("name", "zones"),
    [
        ("corridor", ["corridor"]),
        ("CORRIDOR", ["corridor"]),
        ("lab#2", ["lab#2"]),
        ("lab", ["lab#1", "lab#2"]),
        ("LAB", ["lab#1", "lab#2"]),
        ("Lab", ["room-3"]),  # as it is written, this is a class
        ("library", ["room-2"]),
        ("anna's ROOM", ["room-2"]),
        ("office", ["room-1", "room-2"]),
        ("Office", ["room-1", "room-2"]),
        ("STRASSE", ["Straße"]),
        (unicodedata.normalize("NFD", "CAFÉ"), ["room-3"]),
        ("Ab", ["Ab"]),
        ("aB", ["aB"]),
    ],
)
def test_names_that_are_known(name: str, zones: list[str]) -> None:
    assert list(resolve(OFFICE, name)) == zones


@pytest.mark.parametrize("name", ["", "kitchen", "corridor ", "gone", "nowhere", "lab#3", "\ud800"])
def test_names_that_mean_nothing(name: str) -> None:
    with pytest.raises(UnknownZoneError):
        resolve(OFFICE, name)


def test_case_matters_where_names_differ_in_nothing_else() -> None:
    with pytest.raises(AmbiguousZoneError) as caught:
        resolve(OFFICE, "AB")
    assert caught.value.candidates == ("Ab", "aB")


def test_where_one_zone_is_asked_for() -> None:
    assert resolve_one(OFFICE, "Library") == "room-2"
    with pytest.raises(AmbiguousZoneError) as caught:
        resolve_one(OFFICE, "lab")
    assert caught.value.candidates == ("lab#1", "lab#2")


@pytest.mark.parametrize(
    ("name", "zones"),
    [
        ("office", ["room-1", "room-2"]),
        ("OFFICE", ["room-1", "room-2"]),
        ("lab", ["lab#1", "lab#2"]),
        ("Lab", ["room-3"]),
        ("LAB", ["room-3"]),
    ],
)
def test_a_class_is_noted_or_a_label(name: str, zones: list[str]) -> None:
    assert list(resolve_class(OFFICE, name)) == zones


def test_no_alias_is_a_class() -> None:
    with pytest.raises(UnknownZoneError):
        resolve_class(OFFICE, "library")


@pytest.mark.parametrize(
    ("name", "first"),
    [
        ("corridr", "corridor"), ("korridor", "corridor"), ("COORIDOR", "corridor"),
        ("libary", "library"), ("strasse 1", "Straße"), ("offices", "office"), ("cafe", "Café"),
    ],
)  # fmt: skip
def test_names_that_may_have_been_meant(name: str, first: str) -> None:
    with pytest.raises(UnknownZoneError) as caught:
        resolve(OFFICE, name)
    assert caught.value.closest[0] == first
    assert len(caught.value.closest) <= NAMES_TOLD_MAX


def test_nothing_is_close_to_everything() -> None:
    assert closest_names(OFFICE, "xyz") == ()
    assert closest_names(OFFICE, "room-9") == ("room-1", "room-2", "room-3")
    assert closest_names(Atlas(OFFICE.state.__class__()), "a") == ()


@given(name=st.text(max_size=20), known=st.lists(st.text(min_size=1, max_size=8), unique=True))
def test_any_text_is_a_name_or_none(name: str, known: list[str]) -> None:
    place = atlas((), known)
    assert [resolve(place, zone_id) for zone_id in known] == [(zone_id,) for zone_id in known]
    try:
        assert set(resolve(place, name)) <= set(known)
    except (UnknownZoneError, AmbiguousZoneError):
        assert name not in known


def test_names_are_kept_for_the_next_question() -> None:
    again = Atlas(OFFICE.state, OFFICE.notes, now=7.0)
    assert directory_of(again) is directory_of(OFFICE)
    others = Atlas(OFFICE.state, dict(OFFICE.notes))
    assert directory_of(others) is not directory_of(OFFICE)
    assert directory_of(others).folded_names == directory_of(OFFICE).folded_names
