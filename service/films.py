"""Show how a map grew: a picture for each change of its graph, and an animation of the drive.

All pictures of a film show the same stretch of the world, that of the map in the end.
"""

from __future__ import annotations

import io
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import shapely

from semtopo.errors import InvalidOptionError
from semtopo.graph import Event, NodeFound, NodeMerged, PassageFound, PassageJoined
from semtopo.mapper import MapState, Step
from semtopo.render import render
from semtopo.render.drawing import Drawing, thinned_trail
from semtopo.types import Point
from service.painting import Form, png_of

MOMENTS_MAX = 150
"""Pictures of an animation, about, and at most of changes of the graph; one takes some 0.2 s."""

FRAME = re.compile(r"step-\d{4,}\.(svg|png)")
_SIZE = (1280, 720)
_MILLISECONDS, _LINGER = 120, 1_500  # each picture of an animation; those of a change; the last
_ANIMATED = {".gif": "GIF", ".webp": "WEBP"}


@dataclass(frozen=True, slots=True)
class Moment:
    """A map just after a step, and what the step found."""

    state: MapState
    events: tuple[Event, ...]


@dataclass(slots=True)
class Film:
    """The moments of a drive of `steps` steps that are worth a picture, as they come."""

    steps: int
    moments: list[Moment] = field(default_factory=list)
    changes: int = 0

    def note(self, taken: Step) -> None:
        """Keep a step if it changed the graph, or now and then."""
        stride = -(-self.steps // MOMENTS_MAX)
        is_change = bool(taken.events) and self.changes < MOMENTS_MAX
        self.changes += is_change
        if is_change or taken.state.seq % stride == 0 or taken.state.seq == self.steps:
            self.moments.append(Moment(taken.state, taken.events if is_change else ()))


def check_animation(file: Path) -> None:
    """Refuse an animation that cannot be written.

    Raises
    ------
    InvalidOptionError
        Its name ends in neither .gif nor .webp, or the extra that writes it is missing.
    """
    if file.suffix.lower() not in _ANIMATED:
        raise InvalidOptionError("an animation is a .gif or a .webp")
    try:
        import PIL.Image  # noqa: F401, PLC0415 -- an extra
    except ImportError:
        raise InvalidOptionError("an animation needs: pip install semtopo[animation]") from None


def write_frames(film: Film, path: Sequence[Point], folder: Path, form: Form) -> None:
    """Write a picture of each moment at which the graph changed, named by its step."""
    changes = [moment for moment in film.moments if moment.events]
    for moment, picture in zip(changes, _pictures(film, changes, path), strict=True):
        content = picture.encode() if form is Form.SVG else png_of(picture)
        (folder / f"step-{moment.state.seq:04d}.{form}").write_bytes(content)


def animation_of(film: Film, path: Sequence[Point], suffix: str) -> bytes:
    """Return the moments of a film one after the other, as a GIF or WebP; changes linger."""
    from PIL import Image  # noqa: PLC0415 -- an extra

    frames = [
        Image.open(io.BytesIO(png_of(picture))).convert("RGB")
        for picture in _pictures(film, film.moments, path)
    ]
    times = [_LINGER if moment.events else _MILLISECONDS for moment in film.moments]
    written = io.BytesIO()
    frames[0].save(
        written, _ANIMATED[suffix.lower()], save_all=True, append_images=frames[1:],
        duration=[*times[:-1], 2 * _LINGER], loop=0, optimize=False,
    )  # fmt: skip
    return written.getvalue()


def _pictures(film: Film, moments: Sequence[Moment], path: Sequence[Point]) -> Iterator[str]:
    """Yield the pictures of moments."""
    around = _corners(film.moments[-1].state, path) if film.moments else ()
    for moment in moments:
        yield render(
            moment.state,
            Drawing(
                trail=thinned_trail(path[: moment.state.seq]),
                around=around,
                width=_SIZE[0],
                height=_SIZE[1],
                caption=_caption(moment),
            ),
        )


def _corners(state: MapState, path: Sequence[Point]) -> tuple[Point, Point]:
    """Return two corners of what a whole film shows."""
    regions = [zone.region for zone in state.metric.zones.values()]
    left, low, right, high = shapely.total_bounds([*regions, shapely.MultiPoint(path)])
    return ((left, low), (right, high))


def _caption(moment: Moment) -> str:
    """Say which step it is, and what it found."""
    found = ", ".join(map(_words, moment.events[:4]))
    more = f" and {len(moment.events) - 4} more" if len(moment.events) > 4 else ""  # noqa: PLR2004 -- what fits
    return f"Step {moment.state.seq}" + (f": {found}{more}" if found else "")


def _words(event: Event) -> str:
    """Say in some words what a step found."""
    match event:
        case NodeFound():
            return f"zone {event.zone_id}"
        case NodeMerged():
            return f"zone {event.zone_id} is part of {event.into}"
        case PassageFound():
            return f"passage {event.source} \u2192 {event.target}"
        case PassageJoined():
            return f"passages {event.source} \u2192 {event.target} are one"
