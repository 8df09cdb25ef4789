"""The ellipse holds every way that is short enough, and little more."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from shapely import LineString, Point, box

from semtopo.ellipse import MARGIN, clipped, ellipse

coordinates = st.floats(-1e6, 1e6)
places = st.tuples(coordinates, coordinates)
near = st.tuples(st.floats(-20, 20), st.floats(-20, 20))


@given(one=places, shift=near, extra=st.floats(0, 30), angle=st.floats(0, 7))
def test_whoever_leaves_it_goes_farther(
    one: tuple[float, float], shift: tuple[float, float], extra: float, angle: float
) -> None:
    """Places of the ellipse itself, by its equation about a focus, and MARGIN / 2 beyond it."""
    other = (one[0] + shift[0], one[1] + shift[1])
    apart = math.dist(one, other)
    length = apart + extra
    window = ellipse(one, other, length)
    assert window.is_valid
    to_other = math.atan2(other[1] - one[1], other[0] - one[0])
    lag = length - apart * math.cos(angle - to_other)
    reach = (length**2 - apart**2) / (2 * lag) if lag > 0 else 0.0
    at = (one[0] + reach * math.cos(angle), one[1] + reach * math.sin(angle))
    assert math.dist(one, at) + math.dist(at, other) == pytest.approx(length, abs=1e-6)
    beyond = Point(at).buffer(MARGIN / 2 - 1e-6)
    assert window.covers(beyond)
    assert window.covers(LineString([one, other]))


@given(one=near, other=near, extra=st.floats(0.001, 30))
def test_it_is_hardly_larger_than_need_be(
    one: tuple[float, float], other: tuple[float, float], extra: float
) -> None:
    length = math.dist(one, other) + extra
    rim = shapely.get_coordinates(ellipse(one, other, length))
    farthest = max(math.dist(one, at) + math.dist(at, other) for at in map(tuple, rim))
    assert length < farthest <= (length + MARGIN) * 1.006


def test_from_a_place_to_itself_it_is_a_circle() -> None:
    circle = ellipse((3, 4), (3, 4), 2)
    assert circle.covers(Point(3, 4).buffer(1))
    assert Point(3, 4).buffer(1.01).covers(circle)


def test_what_lies_outside_or_only_touches_is_left_out() -> None:
    regions = np.array([box(0, 0, 2, 2), box(1, 0, 3, 1), box(5, 5, 6, 6)], dtype=np.object_)
    found = clipped(regions, box(0, 0, 1, 1))
    assert [part.bounds for part in found] == [(0, 0, 1, 1)]
