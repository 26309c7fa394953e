"""Times from a fault to the standstill on the bus."""

import statistics
from collections.abc import Sequence
from dataclasses import dataclass

from kurt2rt.checks.faults.suite import FaultTrial
from kurt2rt.checks.faults.table import FaultTable


@dataclass(frozen=True, slots=True)
class StopTime:
    """Measured stop time of the design over all seeds."""

    what: str
    goal_s: float
    median_s: float
    worst_s: float
    trials: int

    @property
    def met(self) -> bool:
        """Return whether the worst time meets the goal."""
        return self.worst_s <= self.goal_s


def stop_times(table: FaultTable, trials: Sequence[FaultTrial]) -> list[StopTime]:
    """Return the table's stop times that were measured."""
    found = []
    for wanted in table.stop_times:
        took_s = [
            outcome.last.after_s
            for case, outcome, _ in trials
            if (case.target, case.kind) == (wanted.target, wanted.kind) and outcome.last is not None
        ]
        if took_s:
            found.append(
                StopTime(wanted.what, wanted.goal_s, statistics.median(took_s), max(took_s), trials=len(took_s))
            )
    return found
