"""How long it takes from the cause to the standstill on the bus."""

import statistics
from collections.abc import Sequence
from dataclasses import dataclass

from kurt2rt.checks.faults.suite import FaultTrial
from kurt2rt.checks.faults.table import FaultTable


@dataclass(frozen=True, slots=True)
class StopTime:
    """One of the design's stop times, over all seeds that were tried."""

    what: str
    goal_s: float
    median_s: float
    worst_s: float
    trials: int

    @property
    def met(self) -> bool:
        """Whether even the worst one is within the goal."""
        return self.worst_s <= self.goal_s


def stop_times(table: FaultTable, trials: Sequence[FaultTrial]) -> list[StopTime]:
    """Those of the table's stop times that were tried and led to a standstill."""
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
