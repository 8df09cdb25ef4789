"""Answers about earlier steps: what one found, and what changed between two."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeAlias

from semtopo.answers.values import ChangesAnswer, Growth, SeenAnswer
from semtopo.atlas import Atlas
from semtopo.errors import UnknownStepError
from semtopo.geometry import NO_AREA
from semtopo.graph import Passage
from semtopo.mapper import MapState
from semtopo.phrases import at, capitalised, listed
from semtopo.questions import ChangesQuestion, SeenQuestion

History: TypeAlias = Callable[[int], MapState]
"""Gives the map as it was after a step that was taken; raises UnknownStepError if it cannot.

Its zones may be missing where only findings are known.
"""


def answer_past(
    atlas: Atlas, question: SeenQuestion | ChangesQuestion, history: History | None
) -> SeenAnswer | ChangesAnswer:
    """Answer a question about earlier steps."""
    if isinstance(question, SeenQuestion):
        return seen(atlas, question, history)
    return changes(atlas, question, history)


def seen(atlas: Atlas, question: SeenQuestion, history: History | None) -> SeenAnswer:
    """Answer what a step found; raises UnknownStepError for one that was not taken."""
    step = question.step
    if step == 0:
        raise UnknownStepError("Steps count from 1; before the first, nothing was seen.")
    state = _state(atlas, step, history)
    zones = tuple(key for key, node in state.graph.nodes.items() if node.seq == step)
    passages = tuple(one for one in state.graph.passages.values() if one.seq == step)
    mapped = state.metric.zones
    grown = tuple(key for key, zone in mapped.items() if zone.since < zone.seq == step)
    is_known = bool(mapped) or not state.graph.nodes
    finds = _findings(zones, passages, grown, ())
    where = "" if state.position is None else f", {at(state.position)}"
    told = f"{_where(state.here)}{where}, step {step} found {finds or 'nothing new'}."
    return SeenAnswer(
        capitalised(told), step, state.here, state.position, zones, passages,
        grown if is_known else None,
    )  # fmt: skip


def changes(atlas: Atlas, question: ChangesQuestion, history: History | None) -> ChangesAnswer:
    """Answer what is different between two steps, the earlier first however they were named.

    Raises UnknownStepError for a step that was not taken.
    """
    until = atlas.state.seq if question.until is None else question.until
    since, until = sorted((question.since, until))
    before, after = _state(atlas, since, history), _state(atlas, until, history)
    old, new = before.graph, after.graph
    zones = tuple(key for key in new.nodes if key not in old.nodes)
    gone = tuple(key for key in old.nodes if key not in new.nodes)
    passages = tuple(one for key, one in new.passages.items() if key not in old.passages)
    grown = _grown(before, after)
    finds = _findings(zones, passages, [it.zone for it in grown or ()], gone)
    sentence = f"Between step {since} and step {until}: {finds or 'nothing changed'}."
    return ChangesAnswer(sentence, since, until, zones, passages, gone, grown)


def _state(atlas: Atlas, step: int, history: History | None) -> MapState:
    """Return the map as of a step; raises UnknownStepError."""
    last = atlas.state.seq
    if step > last:
        raise UnknownStepError(f"The last step was {last}." if last else "No step was taken yet.")
    if step == last:
        return atlas.state
    if step == 0:
        return MapState()
    if history is None:
        raise UnknownStepError("Nothing is known of earlier steps.")
    return history(step)


def _grown(before: MapState, after: MapState) -> tuple[Growth, ...] | None:
    """Return the zones whose ground changed, or `None` if the ground before is not known."""
    old, new = before.metric.zones, after.metric.zones
    if len(old) < len(before.graph.nodes) or len(new) < len(after.graph.nodes):
        return None
    pairs = [(old[key], zone) for key, zone in new.items() if key in old]
    areas = [
        Growth(zone.zone_id, was.region.area, zone.region.area)
        for was, zone in pairs
        if was.seq != zone.seq
    ]
    return tuple(it for it in areas if abs(it.after - it.before) > NO_AREA)


def _findings(
    zones: Sequence[str], passages: Sequence[Passage], grown: Sequence[str], gone: Sequence[str]
) -> str:
    """Return what is new in a few words, or none if nothing is."""
    ways = [f"{one.source} -> {one.target} {at(one.point)}" for one in passages]
    parts = {
        "new": zones,
        "linked": ways,
        "grown": grown,
        "now part of others": gone,
    }
    return "; ".join(f"{word}: {listed(names)}" for word, names in parts.items() if names)


def _where(here: str | None) -> str:
    return "in no zone that is known" if here is None else f"in {here}"
