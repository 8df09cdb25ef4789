"""Time the stages of a step (Table 1), which the library itself cannot: it has no clock."""

from __future__ import annotations

from time import perf_counter

from semtopo.mapper import Stage

_BEFORE_ANY = dict.fromkeys(list(Stage), 0.0)


class Stopwatch:
    """Times one step, from now on: hand `ended` to `scan_world` and `step`."""

    def __init__(self) -> None:
        """Start."""
        self._last = perf_counter()
        self._seconds = _BEFORE_ANY.copy()

    def ended(self, stage: Stage) -> None:
        """Take the time since the last stage ended as that of this one."""
        now = perf_counter()
        self._seconds[stage] += now - self._last
        self._last = now

    def timings_ms(self) -> dict[str, float]:
        """Return the time of each stage and their total, in ms; 0 for a stage that did not end."""
        seconds = self._seconds
        timings = {stage.value: round(1000 * took, 3) for stage, took in seconds.items()}
        return {**timings, "total": round(1000 * sum(seconds.values()), 3)}
