"""Time the stages of a step (Table 1), which the library itself cannot: it has no clock."""

from __future__ import annotations

from time import perf_counter

from semtopo.mapper import Stage


class Stopwatch:
    """Times one step, from now on: hand `ended` to `scan_world` and `step`."""

    def __init__(self) -> None:
        """Start."""
        self._last = perf_counter()
        self._seconds: dict[Stage, float] = dict.fromkeys(list(Stage), 0.0)

    def ended(self, stage: Stage) -> None:
        """Take the time since the last stage ended as that of this one."""
        now = perf_counter()
        self._seconds[stage] += now - self._last
        self._last = now

    def timings_ms(self) -> dict[str, float]:
        """Return the time of each stage and their total, in ms; 0 for a stage that did not end."""
        stages = {str(stage): seconds for stage, seconds in self._seconds.items()}
        timings = {**stages, "total": sum(stages.values())}
        return {name: round(1000 * seconds, 3) for name, seconds in timings.items()}
