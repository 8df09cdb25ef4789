"""Count and time what the service does, for Prometheus; each application counts for itself.

Sessions tell how steps end, and the journal tells what is answered. This room knows neither.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

from prometheus_client import (
    CollectorRegistry,
    Counter,
    Gauge,
    GCCollector,
    Histogram,
    PlatformCollector,
    ProcessCollector,
    generate_latest,
)

from semtopo.mapper import Stage

_SECONDS = (0.0005, 0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1.0, 2.5, 5.0)

_CHANGES = (1, 2, 4, 8, 16, 32, 64)


class Metrics:
    """The counters and histograms of one application."""

    def __init__(self) -> None:
        """Begin at zero."""
        self._registry = registry = CollectorRegistry()
        for collector in (ProcessCollector, PlatformCollector, GCCollector):
            collector(registry=registry)
        self._steps = Counter(
            "semtopo_steps", "Steps, by how they ended", ["outcome"], registry=registry
        )
        self._seconds = Histogram(
            "semtopo_step_seconds", "What the stages of recorded steps took to compute", ["stage"],
            buckets=_SECONDS, registry=registry,
        )  # fmt: skip
        self._stages = {stage: self._seconds.labels(stage) for stage in [*Stage, "total"]}
        self._commit_seconds = Histogram(
            "semtopo_commit_seconds", "What transactions took", buckets=_SECONDS,
            registry=registry,
        )  # fmt: skip
        self._commit_changes = Histogram(
            "semtopo_commit_changes", "Changes in one transaction", buckets=_CHANGES,
            registry=registry,
        )  # fmt: skip
        self._responses = Counter(
            "semtopo_http_responses", "HTTP responses, by class of status", ["status"],
            registry=registry,
        )  # fmt: skip

    def show(self, name: str, about: str, read: Callable[[], int]) -> None:
        """Show a number that is read when it is asked for."""
        gauge = Gauge(f"semtopo_{name}", about, registry=self._registry)
        gauge.set_function(read)

    def count_step(self, outcome: str) -> None:
        """Count a step that ended."""
        self._steps.labels(outcome).inc()

    def time_stages(self, timings_ms: Mapping[str, float]) -> None:
        """Take note of what each stage of a step took."""
        for stage, milliseconds in timings_ms.items():
            self._stages[stage].observe(milliseconds / 1000)

    def time_commit(self, changes: int, seconds: float) -> None:
        """Take note of a transaction; from any thread."""
        self._commit_changes.observe(changes)
        self._commit_seconds.observe(seconds)

    def count_response(self, status: int) -> None:
        """Count a response."""
        self._responses.labels(f"{status // 100}xx").inc()

    def written(self) -> bytes:
        """Return everything in the text format of Prometheus."""
        return generate_latest(self._registry)
