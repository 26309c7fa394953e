"""History of decisions over the log of a lesson in a batch."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from kurt2rt.core.reinforcement.decision_history import DecisionHistory
from simbridge.contracts.batch_lesson import LessonCause, LessonLog

_TEACHABLE = frozenset(map(int, LessonCause)) - {int(LessonCause.STOPPED)}
"""Causes of ticks that a held action may become a lesson about: in a batch a teacher drives by holding an action."""

_LEARNER = int(LessonCause.LEARNER)


class LoggedDecisions(DecisionHistory):
    """Decision history of a compiled lesson, read from its log up to the tick `newest`.

    Its owner sets `newest`. No tick is missed, and none has an opinion. A copy shares the log, so it takes no time.
    """

    def __init__(
        self,
        log: LessonLog,
        average_steps: int,
        actions: Sequence[str],
        behaviours: Sequence[str] = ("",),
        capacity: int = 1000,
    ) -> None:
        """Read `log`, which its owner writes.

        Args:
            log: course of the lesson.
            average_steps: steps of the averages in a situation.
            actions: names of the actions, by their indexes in the log.
            behaviours: names of the taught behaviours, by their indexes in the log.
            capacity: ticks that are remembered.
        """
        super().__init__(0, capacity)
        self._log = log
        self._action_names, self._behaviour_names = tuple(actions), tuple(behaviours)
        self._average_steps = average_steps

    def empty_copy(self, capacity: int) -> "LoggedDecisions":
        """Return an empty history of the last `capacity` ticks of the same log."""
        return LoggedDecisions(self._log, self._average_steps, self._action_names, self._behaviour_names, capacity)

    def copy_ticks(self, other: DecisionHistory, first: int, count: int, number: int) -> None:
        """Copy nothing: the log keeps all ticks."""

    def number_of(self, tick: int, number: int) -> int:
        """Return the tick itself, by which the log is read."""
        del number
        return tick

    def contains(self, tick: int) -> bool:
        """Return whether a tick is stored; ask before reading anything of a tick."""
        return max(1, self.newest - self._capacity + 1) <= tick <= self.newest

    def has_situation(self, tick: int) -> bool:  # noqa: ARG002 - a simulated robot is never blind
        """Return True: a robot in a batch always has sensor data."""
        return True

    def teachable(self, tick: int) -> bool:
        """Return whether a held action may become a lesson about a stored tick."""
        return self._log.causes.item(tick) in _TEACHABLE

    def touched(self, tick: int) -> bool:  # noqa: ARG002 - lessons of scripted teachers
        """Return False: a robot that a scripted teacher teaches does not ask at a bumper."""
        return False

    def situation(self, tick: int) -> NDArray[np.float64]:
        """Return the situation (d,) of a logged tick."""
        features, sums = self._log.features[tick], self._log.sums[tick]
        return np.concatenate((features.astype(np.float64), sums / float(self._average_steps)))

    def driving_rla(self, tick: int) -> int | None:
        """Return the id of the RLA that drove in a stored tick; None if none did."""
        return abs(int(self._log.rlas[tick])) or None

    def learner_action(self, tick: int) -> str:
        """Return the action by which a learner that is no RLA system drove in a stored tick; empty if none did."""
        drove = self._log.causes.item(tick) == _LEARNER
        return self._action_names[self._log.actions.item(tick)] if drove else ""

    def behaviour(self, tick: int) -> str:
        """Return the active taught behaviour of a logged tick."""
        return self._behaviour_names[self._log.behaviours.item(tick)]
