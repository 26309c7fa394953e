"""Statistics of use: unlike a lesson, the last second of them may be lost. Rewards, appraisals, expectations."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, slots=True)
class Expectation:
    """Part E of an RLA (paper, section III.A.3): the mean situation in which it ended and another one took over.

    The paper leaves E open; here it is mean and spread over `count` ends, by Welford's sums. `Expectations` updates
    it at each end, the planner reads it as the end of an edge. Arrays are packed float64.
    """

    lesson: str
    """Command id of the lesson that gave the RLA its action; another action has another expectation."""
    count: int
    """Number of ends so far."""
    ticks: float
    """Mean duration in ticks."""
    packed_mean: bytes
    packed_squares: bytes

    @property
    def mean(self) -> NDArray[np.float64]:
        """Expected situation, shape (d,), not weighted; of symbols the most frequent ones."""
        return np.frombuffer(self.packed_mean, dtype="<f8")

    @property
    def squares(self) -> NDArray[np.float64]:
        """Sum of squared deviations from the mean, shape (d,); of symbols the number of other symbols."""
        return np.frombuffer(self.packed_squares, dtype="<f8")

    @property
    def spread(self) -> NDArray[np.float64]:
        """Standard deviation of each feature, shape (d,); zeros before the second end."""
        spread: NDArray[np.float64] = np.sqrt(self.squares / max(self.count - 1, 1))
        return spread


def pack(values: NDArray[np.float64]) -> bytes:
    """Return the bytes of an array (d,) as an expectation stores them, to the last bit."""
    return np.asarray(values, dtype="<f8").tobytes()


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


class Appraisal(NamedTuple):
    """Number of rewards (+1) and punishments (-1) that teachers and the critic gave one RLA.

    Lists and explanations show it; the value of the RLA is kept by `TdLambda`.
    """

    rewards: int = 0
    punishments: int = 0


class RewardCounts:
    """Numbers of rewards of +1 and -1 that each RLA got; undone rewards are subtracted."""

    def __init__(self) -> None:
        self._counts: Counter[tuple[int, bool]] = Counter()

    def get(self, rla_id: int) -> Appraisal:
        """Return the numbers of an RLA; zeros without rewards."""
        return Appraisal(self._counts[rla_id, True], self._counts[rla_id, False])

    def add(self, rla_id: int, value: int, times: int = 1) -> None:
        """Count one reward; `value` is -1 or +1, `times` -1 for a reward that was undone."""
        self._counts[rla_id, value > 0] += times
