"""Statistics of use: unlike a lesson, the last second of them may be lost."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from kurt2rt.core.rla.expectation import Expectation

VALUES_INCLUDE = "rows that the values include"
"""Number of journal rows included in the saved values; credits of later rows are applied at the start."""
FIRST_VALUE = "first value"
"""Value of a newly taught action in the table of values."""
BEST_SCORE = "best score"
BEST_INCLUDES = "rows that the best knowledge includes"
"""Phase 5: score of the best window, and the number of journal rows at its beginning."""


@dataclass(frozen=True, slots=True)
class Statistics:
    """Counts and values since the knowledge was created. Do not change it once it is handed to the writer."""

    uses: Mapping[int, int] = field(default_factory=dict)
    """RLA id -> number of uses."""
    transitions: Mapping[tuple[int, int], int] = field(default_factory=dict)
    """(RLA id, follow-up RLA id) -> number of transitions: edges of the RLA network (paper, III)."""
    values: Mapping[int, float] = field(default_factory=dict)
    """RLA id -> value, as rewards changed it."""
    numbers: Mapping[str, float] = field(default_factory=dict)
    """Single numbers by the names above."""
    expectations: Mapping[int, Expectation] = field(default_factory=dict)
    """RLA id -> expectation; invalid for an RLA that has another action now."""
    answer_delays: Mapping[str, tuple[int, ...]] = field(default_factory=dict)
    """Teacher -> their last times from question to answer in ticks of real time, oldest first."""


def follow_ups(statistics: Statistics) -> dict[int, dict[int, float]]:
    """Return RLA id -> {follow-up id: percent of its transitions}, most frequent follow-up first."""
    totals: dict[int, int] = {}
    for (before, _), count in statistics.transitions.items():
        totals[before] = totals.get(before, 0) + count
    shares: dict[int, dict[int, float]] = {}
    for (before, after), count in sorted(
        statistics.transitions.items(), key=lambda edge: (edge[0][0], -edge[1], edge[0])
    ):
        if count > 0:
            shares.setdefault(before, {})[after] = 100 * count / totals[before]
    return shares
