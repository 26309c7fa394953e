"""Ticks of a lesson in a batch that its teacher has not seen yet."""

import numpy as np
from numpy.typing import NDArray


class LessonAhead:
    """Ticks that were driven and that a teacher may skip (kurt2rt.teacher.scripted.basic_teacher.Ahead)."""

    def __init__(self, questions: NDArray[np.intp], differences: NDArray[np.intp], changes: NDArray[np.intp]) -> None:
        """Know the ticks of questions and so on, ascending, each (n,)."""
        self._questions, self._differences, self._changes = questions, differences, changes
        self._tick = 0
        self.ticks = 0
        """Number of known ticks."""

    def after(self, tick: int, until: int) -> "LessonAhead":
        """Look from the tick after `tick` on, up to `until`."""
        self._tick, self.ticks = tick, until - tick
        return self

    @property
    def until_question(self) -> int:
        """Number of ticks before the first in which the robot asks; all without one."""
        return self._until(self._questions)

    @property
    def until_difference(self) -> int:
        """Number of ticks before the first in which it asks or does another action than the policy's."""
        return self._until(self._differences)

    @property
    def until_change(self) -> int:
        """Number of ticks before the first with another action, or another right action, than in the tick before."""
        return self._until(self._changes)

    def _until(self, ticks: NDArray[np.intp]) -> int:
        place = ticks.searchsorted(self._tick, side="right")
        return min(ticks.item(place) - 1 - self._tick, self.ticks) if place < len(ticks) else self.ticks
