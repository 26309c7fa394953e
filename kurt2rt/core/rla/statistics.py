"""Statistics of use: unlike a lesson, the last second of them may be lost. Uses, rewards, expectations."""

from collections import Counter
from collections.abc import Callable, Container, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kurt2rt.core.rla.rla import BASIC


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


class StatisticsCounter:
    """Counter of uses of RLAs and of transitions between them, per level.

    An RLA is used once each time it becomes the driving one; standstill ends a chain of transitions.
    """

    def __init__(
        self, uses: dict[int, int] | None = None, transitions: dict[tuple[int, int], int] | None = None
    ) -> None:
        self.uses = Counter(uses)
        self.transitions = Counter(transitions)
        self._followers: dict[int, tuple[int, ...]] = {}
        """Follow-ups of each RLA, for a lookup without a search; tuples take less memory than sets."""
        for before, after in self.transitions:
            self._add_follower(before, after)
        self._previous: dict[str, int | None] = {}
        """Driving RLA of the last tick, by level."""

    def follow_ups(self, rla_id: int) -> dict[int, int]:
        """Return follow-up id -> number of transitions from this RLA."""
        return {after: self.transitions[rla_id, after] for after in sorted(self._followers.get(rla_id, ()))}

    def count(self, current: int | None, level: str = BASIC, *, again: bool = False) -> None:
        """Count one tick; `current`: driving RLA of the level, None at standstill.

        `again`: count a further use if the same RLA was chosen once more.
        """
        previous = self._previous.get(level)
        if current == previous and not again:
            return
        if current is not None:
            self.uses[current] += 1
            if previous is not None:
                if (previous, current) not in self.transitions:
                    self._add_follower(previous, current)
                self.transitions[previous, current] += 1
        self._previous[level] = current

    def drop_deleted(self, is_active: Callable[[int], bool]) -> None:
        """Drop the RLAs for which `is_active` returns False: autonomous robots create and delete many in a day."""
        deleted = {rla_id for rla_id in self.uses if not is_active(rla_id)}
        if not deleted:
            return
        for rla_id in deleted:
            del self.uses[rla_id]
        for edge in [edge for edge in self.transitions if not deleted.isdisjoint(edge)]:
            del self.transitions[edge]
        for rla_id in deleted:
            self._followers.pop(rla_id, None)
        for before, followers in self._followers.items():
            if not deleted.isdisjoint(followers):
                self._followers[before] = tuple(after for after in followers if after not in deleted)
        self._reset_predecessors(deleted)

    def drop_follow_ups(self, rla_id: int) -> None:
        """Drop the counted transitions from an RLA whose action has changed."""
        for after in self._followers.pop(rla_id, ()):
            del self.transitions[rla_id, after]
        self._reset_predecessors((rla_id,))

    def _add_follower(self, before: int, after: int) -> None:
        self._followers[before] = (*self._followers.get(before, ()), after)

    def _reset_predecessors(self, rla_ids: Container[int]) -> None:
        """Count no transition from these RLAs into the next one."""
        for level, previous in self._previous.items():
            if previous in rla_ids:
                self._previous[level] = None
