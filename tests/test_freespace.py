"""Dense paths: on specimens small enough to see, and against a full visibility graph."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import islice
from random import Random

import numpy as np
import pytest
import shapely
from shapely import LineString, MultiPolygon, Polygon, box

from semtopo import freespace
from semtopo.bottleneck import Bottleneck, find_bottleneck
from semtopo.errors.ways import NotConnectedError, OutsideError, TooNarrowError, UnprovedPathError
from semtopo.freespace import SNAP, FreeSpace, Path
from semtopo.geometry import Region, polygonal
from semtopo.inset import SLACK
from semtopo.types import Point
from tests.regions import DRAWS, Draw, far_away, place, touching, turned_grid
from tests.visibility import ShortestWays

every_draw = pytest.mark.parametrize("draw", DRAWS, ids=lambda draw: draw.__name__)

CORRIDOR = polygonal(box(0, 0, 10, 4).difference(box(1, 1, 9, 3)))
"""A ring of corridors, 1 m wide, as round the rooms of the paper's world."""

ROOMS = polygonal(shapely.union_all([box(0, 0, 4, 4), box(4, 1, 5, 2), box(5, 0, 9, 4)]))
"""Two rooms and a doorway, 1 m wide and deep."""


def check(space: FreeSpace, path: Path) -> None:
    """See that a path keeps to free space, with nothing of the code under test."""
    line = LineString(path.points)
    assert space.region.covers(line)
    clearance = line.distance(space.region.boundary)
    assert clearance >= space.radius
    assert path.clearance == pytest.approx(clearance, abs=1e-12)
    assert path.length == pytest.approx(line.length, abs=1e-12)


def test_a_straight_path_is_straight() -> None:
    path = FreeSpace(ROOMS).path((1, 1.5), (8, 1.5))
    assert path.points == ((1.0, 1.5), (8.0, 1.5))
    assert path.length == pytest.approx(7)
    assert path.clearance == 0.5


def test_a_path_bends_at_corners_alone() -> None:
    path = FreeSpace(ROOMS).path((2, 4), (7, 4))
    assert np.allclose(path.points, [(2, 4), (4, 2), (5, 2), (7, 4)], rtol=0, atol=SNAP)
    assert path.length == pytest.approx(1 + 2 * math.sqrt(8), abs=SNAP)


def test_a_robot_rounds_corners_at_its_radius() -> None:
    space = FreeSpace(ROOMS, 0.25)
    path = space.path((2, 3.5), (7, 3.5))
    check(space, path)
    assert 0.25 <= path.clearance <= 0.25 * (1 + SLACK)
    ends = math.dist((2, 3.5), (4, 2)), math.dist((5, 2), (7, 3.5))
    tangents = sum(math.sqrt(end**2 - 0.25**2) for end in ends)
    turn = math.atan2(1.5, 2) + math.asin(0.25 / ends[0])
    expected = tangents + 1 + 2 * 0.25 * turn
    assert expected < path.length < 1.002 * expected


def test_the_shorter_way_round_a_ring_is_taken() -> None:
    """A funnel in one corridor of triangles may take the longer one."""
    space = FreeSpace(CORRIDOR)
    for x in (1.5, 4.9, 5.1, 8.5):
        path = space.path((x, 0.5), (x, 3.5))
        side = min(x - 1, 9 - x)
        assert path.length == pytest.approx(2 + 2 * math.hypot(side, 0.5), abs=SNAP)


def test_a_place_to_itself_is_no_way() -> None:
    assert FreeSpace(ROOMS).path((1, 1), (1, 1)) == Path(((1, 1), (1, 1)), 0.0, 1.0)
    assert FreeSpace(ROOMS).distance((1, 1), (1, 1)) == 0


def test_ends_on_the_border_and_at_vertices_will_do() -> None:
    space = FreeSpace(ROOMS)
    for end in [(0, 0), (4, 2), (9, 4), (0, 1.7), (4.5, 1)]:
        path = space.path(end, (2, 2))
        check(space, path)
        assert math.dist(path.points[0], end) <= SNAP
        assert math.dist(path.points[-1], (2, 2)) == 0


@pytest.mark.parametrize("end", ["start", "goal"])
def test_a_place_outside_is_refused_with_the_nearest_one_inside(end: str) -> None:
    places = [(-1.0, 2.0), (2.0, 2.0)]
    with pytest.raises(OutsideError, match=f"The {end} is not in free space") as caught:
        FreeSpace(ROOMS).path(*(places if end == "start" else places[::-1]))
    assert caught.value.end == end
    assert caught.value.nearest == pytest.approx((0, 2), abs=SNAP)
    assert caught.value.facts == {"end": end, "nearest": caught.value.nearest}


def test_a_place_too_near_to_a_wall_is_refused_with_the_nearest_that_will_do() -> None:
    space = FreeSpace(ROOMS, 0.25)
    with pytest.raises(OutsideError, match=r"0\.100 m from a wall.* needs 0\.250 m") as caught:
        space.path((2, 2), (0.1, 2))
    nearest = caught.value.nearest
    assert nearest is not None
    assert nearest == pytest.approx((0.25, 2), abs=0.25 * SLACK)
    check(space, space.path((2, 2), nearest))


def test_a_door_too_narrow_is_told_with_place_and_width() -> None:
    with pytest.raises(TooNarrowError, match=r"must be 1\.200 m") as caught:
        FreeSpace(ROOMS, 0.6).path((2, 2), (7, 2))
    assert 4 <= caught.value.point[0] <= 5
    assert caught.value.point[1] == pytest.approx(1.5, abs=0.01)
    assert 1 - SLACK <= caught.value.width <= 1
    assert caught.value.needed == 1.2


def test_where_a_way_is_too_narrow_is_found_once(monkeypatch: pytest.MonkeyPatch) -> None:
    space, asked = FreeSpace(ROOMS, 0.6), list[Point]()

    def counted(region: Region, start: Point, goal: Point, radius: float) -> Bottleneck | None:
        asked.append(goal)
        return find_bottleneck(region, start, goal, radius)

    monkeypatch.setattr(freespace, "find_bottleneck", counted)
    told = []
    for goal in ((7.0, 2.0), (7.0, 2.0), (7.5, 2.0)):
        with pytest.raises(TooNarrowError) as caught:
            space.path((2.0, 2.0), goal)
        told.append(str(caught.value))
    assert told[0] == told[1]
    assert asked == [(7.0, 2.0), (7.5, 2.0)]


def test_of_two_narrow_ways_the_wider_is_told() -> None:
    region = box(0, 0, 9, 9).difference(box(4, 0, 5, 8.3)).difference(box(4, 8.8, 5, 9))
    region = polygonal(region.union(box(3.9, 2, 5.1, 2.3)))
    with pytest.raises(TooNarrowError) as caught:
        FreeSpace(polygonal(region), 0.4).path((2, 2.1), (7, 2.1))
    assert caught.value.point == pytest.approx((4.5, 8.55), abs=0.51)
    assert 0.5 * (1 - SLACK) <= caught.value.width <= 0.5


def test_a_pinch_between_two_vertices_is_found_where_it_is() -> None:
    notches = Polygon([(4, 0), (5, 1.6), (6, 0)]), Polygon([(4, 4), (5, 2.4), (6, 4)])
    region = polygonal(box(0, 0, 10, 4).difference(shapely.union_all(notches)))
    with pytest.raises(TooNarrowError) as caught:
        FreeSpace(region, 0.5).path((2, 2), (8, 2))
    assert caught.value.point == pytest.approx((5, 2), abs=0.05)
    assert 0.8 * (1 - SLACK) <= caught.value.width <= 0.8


def test_a_robot_that_fits_nowhere_is_told_the_widest_place() -> None:
    space = FreeSpace(box(0, 0, 9, 1), 0.75)
    with pytest.raises(TooNarrowError) as caught:
        space.path((1, 0.5), (8, 0.5))
    assert caught.value.width == pytest.approx(1, rel=0.02)
    assert caught.value.needed == 1.5
    assert space.nearest_place((1, 0.5)) is None


def test_parts_that_do_not_meet_are_not_connected() -> None:
    region = MultiPolygon([box(0, 0, 1, 1), box(2, 0, 3, 1)])
    for radius in (0.0, 0.25):
        with pytest.raises(NotConnectedError):
            FreeSpace(region, radius).path((0.5, 0.5), (2.5, 0.5))


def test_what_meets_in_a_point_is_not_connected_there() -> None:
    ring = box(0, 0, 3, 3).difference(Polygon([(1, 0), (1.5, 3), (2, 0)]))
    assert isinstance(ring, MultiPolygon | Polygon)
    with pytest.raises(NotConnectedError):
        FreeSpace(polygonal(ring)).path((0.2, 2.8), (2.8, 2.8))


def test_no_region_is_no_place_to_be() -> None:
    with pytest.raises(OutsideError) as caught:
        FreeSpace(Polygon()).path((0, 0), (1, 1))
    assert caught.value.nearest is None


def test_a_path_that_leaves_free_space_is_not_handed_out(monkeypatch: pytest.MonkeyPatch) -> None:
    for wrong in ([(2.0, 3.0), (7.0, 3.0)], [(2.0, 3.0), (-2.0, 3.0)], [(2.0, 0.1), (7.0, 0.1)]):
        monkeypatch.setattr(freespace, "shortest_polyline", lambda *_, wrong=wrong: wrong)
        with pytest.raises(UnprovedPathError):
            FreeSpace(ROOMS, 0.25).path((2, 3), (7, 3))


def test_the_clearance_of_a_place_counts_inside_and_outside() -> None:
    space = FreeSpace(ROOMS)
    assert space.clearance((2, 1)) == 1
    assert space.clearance((-2, 1)) == 2
    assert space.clearance((0, 0)) == 0


def test_the_same_question_has_the_same_answer() -> None:
    one, other = FreeSpace(CORRIDOR, 0.2), FreeSpace(CORRIDOR, 0.2)
    assert (
        one.path((5, 0.5), (5, 3.5))
        == other.path((5, 0.5), (5, 3.5))
        == one.path((5, 0.5), (5, 3.5))
    )


def ends(random: Random, space: FreeSpace) -> tuple[Point, Point]:
    """Return two places where the robot may be, near to hard places of the region."""
    one, other = (space.nearest_place(place(random, space.region)) for _ in range(2))
    assert one is not None
    assert other is not None
    return one, other


@pytest.mark.parametrize("draw", [*DRAWS, far_away(turned_grid)], ids=lambda it: it.__name__)
@pytest.mark.parametrize("radius", [0.0, 0.1])
def test_paths_are_as_short_as_the_visibility_graph(draw: Draw, radius: float) -> None:
    spaces = (FreeSpace(draw(Random(seed)), radius) for seed in range(80))
    small = (one for one in spaces if 0 < shapely.get_num_coordinates(one.inset) < 400)
    bends = [bend for space in islice(small, 4) for bend in compared(Random(1), space)]
    assert len(bends) >= 6
    assert sum(bend > 0 for bend in bends) >= 2


def compared(random: Random, space: FreeSpace) -> Iterator[int]:
    """Compare some paths with the oracle's; yield how often each bends."""
    ways = ShortestWays(space.inset)
    for _ in range(10):
        start, goal = ends(random, space)
        best = ways.length(start, goal)
        try:
            path = space.path(start, goal)
        except (NotConnectedError, TooNarrowError):
            assert best is None
            continue
        check(space, path)
        assert path.points[0] == pytest.approx(start, rel=0, abs=1e-9)
        assert path.points[-1] == pytest.approx(goal, rel=0, abs=1e-9)
        assert path.length == pytest.approx(best, abs=1e-7)
        yield len(path.points) - 2


def test_what_lies_straight_ahead_is_not_missed() -> None:
    """Two corners in line with the start: rounding puts the second behind neither side."""
    space = FreeSpace(touching(Random(1021)))
    length = space.distance((6, 9), (9.521493320005886, 1.4785066799941136))
    assert length == pytest.approx(7 * math.sqrt(2) + 0.7375, abs=1e-3)


@every_draw
def test_no_path_leaves_free_space(draw: Draw) -> None:
    found = 0
    for seed in range(25):
        random = Random(seed)
        region = draw(random)
        for radius in (0.0, random.choice([0.02, 0.1, 0.25])):
            space = FreeSpace(region, radius)
            if not space.inset.is_empty:
                found += sum(walks(random, space) for _ in range(8))
    assert found > 80


def walks(random: Random, space: FreeSpace) -> bool:
    """Say whether there was a path between two places; see that it keeps to free space."""
    start, goal = ends(random, space)
    try:
        path = space.path(start, goal)
    except NotConnectedError:
        return False
    except TooNarrowError as caught:
        narrow = caught
    else:
        check(space, path)
        return True
    assert 0 <= narrow.width <= narrow.needed
    assert space.region.distance(shapely.Point(narrow.point)) <= SNAP
    return False


def test_regions_are_hard_enough() -> None:
    drawn: list[Region] = [draw(Random(seed)) for draw in DRAWS for seed in range(25)]
    holes = [len(shapely.get_rings(shapely.get_parts(one))) for one in drawn]
    assert max(holes) >= 40
    assert sum(isinstance(one, MultiPolygon) for one in drawn) > 25
