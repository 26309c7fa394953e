"""Running mean of measured values."""

from behaviors.metrics.task_metric import Metrics

MEASURE_EVERY = 10
"""Ticks from one measured distance to the next."""


class Mean:
    """Arithmetic mean of all added values."""

    def __init__(self) -> None:
        self._sum = 0.0
        self._count = 0

    def add(self, value: float) -> None:
        """Add a value, in the unit of the metric, such as m."""
        self._sum += value
        self._count += 1

    def as_metric(self, name: str) -> Metrics:
        """Return the mean by its name, {name: mean}; empty without values."""
        return {name: self._sum / self._count} if self._count else {}
