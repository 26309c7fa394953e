"""A mean that grows with what is seen."""

from behaviors.metrics.task_metric import Metrics

MEASURE_EVERY = 10
"""Ticks from one measured distance to the next."""


class Mean:
    """Arithmetic mean of all values so far."""

    def __init__(self) -> None:
        self._sum = 0.0
        self._count = 0

    def add(self, value: float) -> None:
        """One more."""
        self._sum += value
        self._count += 1

    def as_metric(self, name: str) -> Metrics:
        """The mean under a name; nothing when nothing was seen."""
        return {name: self._sum / self._count} if self._count else {}
