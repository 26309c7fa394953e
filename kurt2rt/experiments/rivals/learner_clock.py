"""Clock of a learner: the processor time of its lessons and decisions, and how many lessons act at once."""

import time
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from kurt2rt.core.learner.learner import OWN, Driven, Learner, LearnerFactory, LearnerSetting, SignalLearner, Why


class LearnerClock:
    """Processor time of all learners that were made with it, which other work does not lengthen."""

    def __init__(self) -> None:
        self.lessons = 0
        """Number of lessons with an action."""
        self.followed = 0
        """Number of these that the first decision after them follows in their situation."""
        self.retraining_ns = 0
        """Time of all lessons, each with the first decision after it, which may fit the learner to it."""
        self.longest_ns = 0
        """Time of the longest decision."""

    def restart(self) -> None:
        """Forget all times and counts, because the lesson begins again."""
        self.retraining_ns = self.longest_ns = self.lessons = self.followed = 0

    @property
    def retraining_s(self) -> float:
        """Time of all lessons with the first decision after each, in s."""
        return self.retraining_ns / 1e9

    @property
    def longest_ms(self) -> float:
        """Time of the longest decision in ms."""
        return self.longest_ns / 1e6

    def timed(self, make: LearnerFactory) -> LearnerFactory:
        """Return a maker of the same learners whose time is taken."""

        def make_timed(setting: LearnerSetting) -> Learner:
            learner = make(setting)
            if isinstance(learner, SignalLearner):
                return _TimedSignalLearner(learner, learner, self)
            return _TimedLearner(learner, self)

        return make_timed


def untimed(learner: Learner) -> Learner:
    """Return the learner itself, without the clock that may be around it."""
    return learner.learner if isinstance(learner, _TimedLearner) else learner


class _TimedLearner:
    """Learner whose time is taken (`Learner`)."""

    def __init__(self, learner: Learner, clock: LearnerClock) -> None:
        self.learner = learner
        self._clock = clock
        self._is_taught_since = False
        self._given: list[tuple[NDArray[np.float64], str]] = []
        """Lessons since the last decision: situation (d,) and action."""

    def decide(self, situation: NDArray[np.float64], *, taught: bool) -> str | None:
        began_ns = time.thread_time_ns()
        action = self.learner.decide(situation, taught=taught)
        took_ns = time.thread_time_ns() - began_ns
        self._clock.longest_ns = max(self._clock.longest_ns, took_ns)
        if self._is_taught_since:
            self._clock.retraining_ns += took_ns
            self._is_taught_since = False
            self._count_followed()
        return action

    def lesson(self, situation: NDArray[np.float64], action: str, why: Why) -> None:
        self._learn(lambda: self.learner.lesson(situation, action, why))
        if why not in OWN:
            self._given.append((situation, action))

    def _count_followed(self) -> None:
        self._clock.lessons += len(self._given)
        self._clock.followed += sum(self.learner.decide(there, taught=True) == action for there, action in self._given)
        self._given.clear()

    def _learn(self, lesson: Callable[[], None]) -> None:
        began_ns = time.thread_time_ns()
        lesson()
        self._clock.retraining_ns += time.thread_time_ns() - began_ns
        self._is_taught_since = True

    def snapshot(self) -> bytes:
        return self.learner.snapshot()

    def restore(self, data: bytes) -> None:
        self.learner.restore(data)


class _TimedSignalLearner(_TimedLearner):
    """Learner of rewards whose time is taken (`SignalLearner`)."""

    def __init__(self, learner: Learner, rewarded: SignalLearner, clock: LearnerClock) -> None:
        super().__init__(learner, clock)
        self._rewarded = rewarded

    def signal(self, driven: Sequence[Driven], value: int) -> None:
        self._learn(lambda: self._rewarded.signal(driven, value))
