"""Hypothesis strategies, built so that what they draw is never trivial.

Random rectangles with a random robot show one zone or none in nine cases of ten, and then every
property holds. So scenes are built around the robot: it stands in a space, next to a door to
another space, and something solid is in sight. `test_mapper.test_scenes_are_not_vacuous` and
`test_zones.test_runs_are_not_vacuous` count.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import accumulate
from typing import TypeAlias

from hypothesis import settings
from hypothesis import strategies as st

from semtopo.runs import LabelledRuns
from semtopo.sensor import Sensor
from semtopo.types import Edges, Identity, Kind, MappingOptions, Passages, Point, Pose, Sensing
from semtopo.world import World, WorldZone

SPACES = ("a", "b", "c")
KINDS = {"door": Kind.PASSAGE, "wall": Kind.OBSTACLE, "fog": Kind.UNKNOWN}
"""All other labels are spaces."""

_CELLS = st.sampled_from([*SPACES, *SPACES, "door", "door", "wall", "wall", "fog"])
_EDGE = 1 / 32  # m: robots stand on odd multiples, so no sample lies on the edge of a cell


Beam: TypeAlias = list[tuple[str, float]]
"""Labels with the radii in m where they end."""

_WHOLE: Beam = []
_BROKEN: list[Beam] = [[("b", 2.0), ("fog", 2.5)], [("b", 2.25), ("door", 3.0)]]


@dataclass(frozen=True)
class Scene:
    """A world, a sensor and the positions from which the robot looks, all inside the world."""

    world: World
    sensor: Sensor
    walk: tuple[Point, ...]

    def moved(self, dx: float, dy: float) -> Scene:
        """Return the scene somewhere else."""
        zones = [
            replace(
                zone,
                low=(zone.low[0] + dx, zone.low[1] + dy),
                high=(zone.high[0] + dx, zone.high[1] + dy),
            )
            for zone in self.world.zones
        ]
        return Scene(World(zones), self.sensor, tuple((x + dx, y + dy) for x, y in self.walk))


def zone(label: str, low: Point, high: Point) -> WorldZone:
    """Return a rectangle whose kind follows from its label."""
    return WorldZone(label, KINDS.get(label, Kind.SPACE), low, high)


@st.composite
def lattice_worlds(draw: st.DrawFn) -> World:
    """Draw 1 to 8 rectangles with corners on integers from 0 to 6: they overlap and share edges."""
    spans = st.lists(st.integers(0, 6), min_size=2, max_size=2, unique=True).map(sorted)
    rectangles = draw(st.lists(st.tuples(_CELLS, spans, spans), min_size=1, max_size=8))
    return World([zone(label, (x[0], y[0]), (x[1], y[1])) for label, x, y in rectangles])


lattice_points = st.lists(
    st.tuples(st.integers(-2, 14), st.integers(-2, 14)).map(lambda p: (p[0] / 2, p[1] / 2)),
    min_size=1,
    max_size=20,
)
"""Lists of points on halves, so corners, edges, insides and outsides of lattice worlds."""


@st.composite
def sensors(draw: st.DrawFn) -> Sensor:
    """Draw a sensor of 12 to 36 beams that reaches two or three cells far.

    No whole or half number of steps leads from an odd multiple of 1/32 m to a multiple of 1/8 m.
    """
    beams = draw(st.sampled_from([12, 15, 16, 24, 36]))
    samples = draw(st.sampled_from([8, 10, 20]))
    return Sensor(beams=beams, range=draw(st.sampled_from([2.0, 2.4])), samples=samples)


@st.composite
def scenes(draw: st.DrawFn, walk: int = 4) -> Scene:
    """Draw a tiling of 4 x 4 cells, perhaps with a rug on it, and a walk of up to `walk` positions.

    The first position lies in a cell `a`. Beyond a narrow door to its right lies `b`, above it a
    wall. All the other cells, and the other positions, are drawn freely.
    """
    cells = [[draw(_CELLS) for _ in range(4)] for _ in range(4)]
    column, row = draw(st.integers(0, 1)), draw(st.integers(0, 2))
    cells[column][row], cells[column + 1][row], cells[column + 2][row] = "a", "door", "b"
    cells[column][row + 1] = "wall"
    widths = [draw(st.sampled_from([0.75, 1.0, 1.25])) for _ in range(4)]
    widths[column + 1] = draw(st.sampled_from([0.25, 0.5]))
    x = list(accumulate(widths, initial=0.0))
    y = list(accumulate((draw(st.sampled_from([0.75, 1.0, 1.25])) for _ in range(4)), initial=0.0))
    tiles = [
        zone(cells[i][j], (x[i], y[j]), (x[i + 1], y[j + 1])) for i in range(4) for j in range(4)
    ]
    start = (
        draw(_between(x[column + 1] - 0.25, x[column + 1])),
        draw(_between(y[row] + 0.25, y[row + 1] - 0.25)),
    )
    others = draw(
        st.lists(st.tuples(_between(0.0, x[-1]), _between(0.0, y[-1])), max_size=walk - 1)
    )
    rugs = draw(st.lists(_rugs(start), max_size=1))
    return Scene(World([*tiles, *rugs]), draw(sensors()), (start, *others))


def _between(low: float, high: float) -> st.SearchStrategy[float]:
    """Draw an odd multiple of 1/32 m between two multiples of 1/8 m."""
    cells = round((high - low) / _EDGE) // 2
    return st.integers(0, cells - 1).map(lambda number: low + (2 * number + 1) * _EDGE)


@st.composite
def _rugs(draw: st.DrawFn, start: Point) -> WorldZone:
    """Draw a rectangle that lies on the tiles, left of the start: the later zone wins (R4)."""
    width, depth = draw(st.sampled_from([0.25, 0.5])), draw(st.sampled_from([0.25, 0.5]))
    left, bottom = math.floor(start[0] * 4) / 4 - width, math.floor(start[1] * 4) / 4
    return zone(draw(_CELLS), (left, bottom), (left + width, bottom + depth))


offsets = st.tuples(*[st.sampled_from([-64.0, -8.0, -0.25, 0.0, 0.5, 16.0, 1024.0])] * 2)
"""Shifts in m that are exact in binary, so that no sample changes sides."""

options = st.builds(
    MappingOptions, edges=st.sampled_from(Edges), min_zone_area=st.sampled_from([0.0, 0.0, 0.05])
)
"""Mapping options with a zone for each label, and one passage between two."""

instances = st.builds(
    MappingOptions,
    edges=st.sampled_from(Edges),
    passages=st.sampled_from(Passages),
    identity=st.just(Identity.INSTANCE),
    min_zone_area=st.sampled_from([0.0, 0.0, 0.05]),
)
"""Mapping options with a zone for each place."""

all_options = st.one_of(
    options,
    instances,
    st.builds(MappingOptions, edges=st.sampled_from(Edges), passages=st.just(Passages.ALL)),
    st.builds(
        MappingOptions, sensing=st.sampled_from(Sensing), tolerance=st.sampled_from([0.02, 0.3])
    ),
)
"""All mapping options."""


@st.composite
def labelled_runs(draw: st.DrawFn) -> LabelledRuns:
    """Draw 4 to 8 beams of labelled runs; neighbours resemble each other, so that strips form.

    Two neighbours go from `a` through a door to `b`; on the one, `b` may be in two pieces. The
    other beams are drawn freely. The sensor looks all around, or ahead, or backwards; clockwise
    or not.
    """
    free = draw(st.lists(_beams(), min_size=1, max_size=3))
    order = draw(st.lists(st.sampled_from(range(len(free))), min_size=2, max_size=6))
    beams = [free[number] for number in order]
    start = draw(st.integers(0, len(beams)))
    pair = [draw(_through_a_door([_WHOLE])), draw(_through_a_door([_WHOLE, *_BROKEN]))]
    beams[start:start] = draw(st.permutations(pair))
    step = draw(st.sampled_from([2 * math.pi / len(beams), 0.2, 0.7]))
    return LabelledRuns(
        angle_min=draw(st.sampled_from([0.0, -math.pi / 2, 2.0])),
        angle_increment=step * draw(st.sampled_from([1, -1])),
        range_max=4.0,
        beams=beams,
        kinds=dict(KINDS),
    )


@st.composite
def _through_a_door(draw: st.DrawFn, pieces: list[Beam]) -> Beam:
    """Draw a beam that leads from `a` through a door to `b`, with one of some pieces before it."""
    door = draw(st.sampled_from([0.75, 1.0, 1.25]))
    piece, end = draw(st.sampled_from(pieces)), draw(st.sampled_from([3.5, 4.0]))
    return [("a", door), ("door", door + 0.25), *piece, ("b", end)]


@st.composite
def _beams(draw: st.DrawFn) -> Beam:
    """Draw one beam: labels with ends on quarters of a metre, equal neighbours allowed."""
    ends = sorted(draw(st.sets(st.integers(1, 16), min_size=1, max_size=7)))
    labels = [draw(st.sampled_from([*SPACES, "a", "a", "door", "fog", "wall"])) for _ in ends]
    return [(label, end / 4) for label, end in zip(labels, ends, strict=True)]


poses = st.builds(
    Pose,
    x=st.integers(-8, 8).map(float),
    y=st.integers(-8, 8).map(float),
    theta=st.sampled_from([0.0, 1.0, -2.5]),
)
"""Poses on whole metres."""


quick = settings(max_examples=100, deadline=None)
"""For properties of one scan."""

patient = settings(max_examples=40, deadline=None)
"""For properties of whole runs."""

many = settings(max_examples=200, deadline=None, derandomize=True)
"""For counting: the same draws each time, so that a count near its limit does not waver."""
