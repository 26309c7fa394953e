"""Tests that every learner passes: the promises of `Learner`, tried on made-up lessons."""

import time
from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hal.robot_settings import load_robot
from kurt2rt.core.learner.learner import Learner, LearnerSetting, Why
from kurt2rt.core.task_settings import load_task
from kurt2rt.experiments.lockstep.learner_setting import learner_setting

_LESSONS, _PROBES, _TIMED = 40, 200, 50
_FARTHEST_COUNTS = 500.0
_TOO_LONG_MS = 20.0
"""Two ticks: the guard refuses a decision that is older, and the robot stands."""


class ExampleLessons(NamedTuple):
    """Made-up lessons and situations by which every learner is tested, as a robot would give them."""

    situations: NDArray[np.float64]
    """Situations (n, d) of the lessons, in counts."""
    actions: list[str]
    """Actions of the n lessons."""
    probes: NDArray[np.float64]
    """Situations (m, d) to decide in, in counts."""

    def teach(self, learner: Learner, place: int) -> None:
        """Give a learner the lesson of a place, from 0."""
        why = (Why.ANSWER, Why.CORRECTION, Why.HOLD)[place % 3]
        learner.lesson(self.situations[place], self.actions[place], why)

    def decisions(self, learner: Learner, probes: int = _PROBES) -> list[str | None]:
        """Return what a learner decides in the first of the situations to try, with a teacher and without one."""
        return [learner.decide(probe, taught=taught) for probe in self.probes[:probes] for taught in (True, False)]


def made_up(setting: LearnerSetting) -> ExampleLessons:
    """Return made-up lessons for a learner of this setting, drawn by its seed."""
    rng = np.random.default_rng(setting.seed)
    # Groups, because lessons of a robot lie together; with noise, so that no two situations are equal.
    centres = rng.uniform(0.0, _FARTHEST_COUNTS, (8, setting.dimensions))
    groups = rng.integers(0, len(centres), _LESSONS + _PROBES)
    situations = centres[groups] + rng.normal(0.0, 5.0, (len(groups), setting.dimensions))
    situations.flags.writeable = False
    actions = [setting.actions[group % len(setting.actions)] for group in groups[:_LESSONS]]
    return ExampleLessons(situations[:_LESSONS], actions, situations[_LESSONS:])


class LearnerTests(ABC):
    """Tests of a learner. Inherit them, and say how it is made.

    For example:

        class TestNearest(LearnerTests):
            def make(self, setting):
                return Nearest(setting)
    """

    @abstractmethod
    def make(self, setting: LearnerSetting) -> Learner:
        """Return a new learner of a setting."""

    def setting(self) -> LearnerSetting:
        """Return the setting to try it with, of a task with at least two actions: by default KURT2's wall following."""
        return learner_setting(load_task("wall_following"), load_robot(), seed=1)

    def test_decide_asks_before_the_first_lesson(self) -> None:
        made = made_up(self.setting())
        assert set(made.decisions(self.make(self.setting()), probes=5)) == {None}

    def test_decide_names_an_action_of_the_setting_or_asks(self) -> None:
        decisions = made_up(self.setting()).decisions(self._taught(_LESSONS))
        assert set(decisions) <= {None, *self.setting().actions}

    def test_decide_follows_the_first_lesson_in_its_situation(self) -> None:
        made, learner = made_up(self.setting()), self._taught(1)
        assert [learner.decide(made.situations[0], taught=taught) for taught in (True, False)] == [made.actions[0]] * 2

    def test_decide_changes_nothing(self) -> None:
        made, asked = made_up(self.setting()), self.make(self.setting())
        for place in range(_LESSONS):
            made.teach(asked, place)
            made.decisions(asked, probes=5)
        assert made.decisions(asked) == made.decisions(self._taught(_LESSONS))

    def test_the_same_lessons_give_the_same_decisions(self) -> None:
        made = made_up(self.setting())
        assert made.decisions(self._taught(_LESSONS)) == made.decisions(self._taught(_LESSONS))

    def test_restore_gives_the_decisions_of_the_snapshot_also_after_further_lessons(self) -> None:
        made, half = made_up(self.setting()), _LESSONS // 2
        taught, restored = self._taught(half), self.make(self.setting())
        restored.restore(taught.snapshot())
        assert made.decisions(restored) == made.decisions(taught)
        for place in range(half, _LESSONS):
            made.teach(taught, place)
            made.teach(restored, place)
        assert made.decisions(restored) == made.decisions(taught)

    def test_restore_forgets_all_that_is_not_in_the_snapshot(self) -> None:
        made, learner = made_up(self.setting()), self._taught(_LESSONS)
        for lessons in (0, 1, _LESSONS // 2, 2):
            known = self._taught(lessons)
            learner.restore(known.snapshot())
            assert made.decisions(learner) == made.decisions(known)

    def test_decide_takes_less_than_two_ticks(self) -> None:
        median_ms = decision_time_ms(self._taught(_LESSONS), made_up(self.setting()))
        assert median_ms <= _TOO_LONG_MS, "the guard refuses a decision that is older, so a robot would stand"

    def _taught(self, lessons: int) -> Learner:
        made, learner = made_up(self.setting()), self.make(self.setting())
        for place in range(lessons):
            made.teach(learner, place)
        return learner


def decision_time_ms(learner: Learner, made: ExampleLessons, now_ns: Callable[[], int] = time.thread_time_ns) -> float:
    """Return the median processor time of a learner's decisions, but for the first, which may fit it to its lessons.

    `now_ns`: processor time of this thread, in ns.
    """
    times_ms = []
    for probe in made.probes[: 1 + _TIMED]:
        began_ns = now_ns()
        learner.decide(probe, taught=False)
        times_ms.append((now_ns() - began_ns) / 1e6)
    return float(np.median(times_ms[1:]))
