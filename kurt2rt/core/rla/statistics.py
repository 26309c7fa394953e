"""What the robot counted while it used its knowledge; unlike a lesson, the last second of it may be lost."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from kurt2rt.core.rla.expectation import Expectation

VALUES_INCLUDE = "rows that the values include"
EDGE_WEIGHTS_INCLUDE = "rows that the edge weights include"
"""How many rows the journal had when that table was saved; what lessons behind them are worth is booked later."""
FIRST_VALUE = "first value"
"""What an action that was just taught is worth in the table of values."""
BEST_SCORE = "best score"
BEST_INCLUDES = "rows that the best knowledge includes"
"""Phase 5: the score of the best window, and how many rows the journal had when its knowledge stood."""


@dataclass(frozen=True, slots=True)
class Statistics:
    """Counts and worths since the knowledge was begun. Must not be changed once it is handed over to be written."""

    uses: Mapping[int, int] = field(default_factory=dict)
    """RLA id -> how often it won."""
    transitions: Mapping[tuple[int, int], int] = field(default_factory=dict)
    """(RLA id, follow-up RLA id) -> how often the one followed the other; edges of the RLA network (paper, III)."""
    values: Mapping[int, float] = field(default_factory=dict)
    """RLA id -> what rewards made its value."""
    edge_weights: Mapping[tuple[int, int], float] = field(default_factory=dict)
    """(RLA id, follow-up RLA id) -> weight of the edge, where rewards changed it; the smaller the better."""
    numbers: Mapping[str, float] = field(default_factory=dict)
    """Single numbers by their names, those above."""
    expectations: Mapping[int, Expectation] = field(default_factory=dict)
    """RLA id -> the situation that follows it; of RLAs that have another action by now it says nothing."""


def follow_ups(statistics: Statistics) -> dict[int, dict[int, float]]:
    """Share of each follow-up RLA in percent, most frequent first: RLA id -> {follow-up id: percent}."""
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
