"""The inherited tests of a learner: the RLA system passes, and one that breaks a promise fails the test about it."""

import numpy as np
import pytest
from numpy.typing import NDArray

from kurt2rt.checks.plugins.learner_tests import LearnerTests
from kurt2rt.core.learner.learner import Learner, LearnerFactory, LearnerSetting, Why
from kurt2rt.core.learner.rla_learner import RlaLearner
from tests.core.learner.helpers import SETTING, Parrot

WIDE = SETTING._replace(dimensions=12, weights=np.ones(12), radius=300.0)


class TestRlaLearner(LearnerTests):
    def make(self, setting: LearnerSetting) -> Learner:
        return RlaLearner(setting)


class Made(LearnerTests):
    """Tests of any learner."""

    def __init__(self, factory: LearnerFactory) -> None:
        self._factory = factory

    def make(self, setting: LearnerSetting) -> Learner:
        return self._factory(setting)

    def setting(self) -> LearnerSetting:
        return WIDE


def test_restore_of_foreign_bytes_is_refused() -> None:
    with pytest.raises(ValueError, match="char"):
        RlaLearner(WIDE).restore(b"no snapshot")
    with pytest.raises(ValueError, match="reshape"):
        RlaLearner(WIDE).restore(RlaLearner(WIDE).snapshot() + b"12345678")


class Eager(Parrot):
    """Drives before it was taught anything."""

    def decide(self, situation: NDArray[np.float64], *, taught: bool) -> str | None:
        return super().decide(situation, taught=taught) or "a"


class Fickle(Parrot):
    """Decides by the number of its decisions."""

    def decide(self, situation: NDArray[np.float64], *, taught: bool) -> str | None:
        if self.said:
            self.said.append("abc"[len(self.said) % 3])
        return super().decide(situation, taught=taught)


class Hoarder(Parrot):
    """Keeps what it knew in a restore."""

    def restore(self, data: bytes) -> None:
        before = self.said
        super().restore(data)
        self.said += before


class Forgetful(Parrot):
    """Restores nothing."""

    def restore(self, data: bytes) -> None:  # noqa: ARG002 - it looks at nothing
        self.said = []


class Inventive(Parrot):
    """Names an action that does not exist."""

    def lesson(self, situation: NDArray[np.float64], action: str, why: Why) -> None:
        super().lesson(situation, f"{action}!", why)


class Late(Parrot):
    """Follows the lesson before the last."""

    def decide(self, situation: NDArray[np.float64], *, taught: bool) -> str | None:  # noqa: ARG002 - as its parent
        return self.said[-2] if len(self.said) > 1 else None


_MADE: list[int] = []


class Moody(Parrot):
    """Decides by the number of learners that were made."""

    def __init__(self, setting: LearnerSetting) -> None:
        super().__init__(setting)
        _MADE.append(1)
        self._mood = len(_MADE)

    def decide(self, situation: NDArray[np.float64], *, taught: bool) -> str | None:  # noqa: ARG002 - as its parent
        return self.said[-1] if len(self.said) == 1 else "abc"[self._mood % 3] if self.said else None


@pytest.mark.parametrize(
    ("learner", "promise"),
    [
        (Eager, "decide_asks_before_the_first_lesson"),
        (Fickle, "decide_changes_nothing"),
        (Hoarder, "restore_forgets_all_that_is_not_in_the_snapshot"),
        (Forgetful, "restore_gives_the_decisions_of_the_snapshot_also_after_further_lessons"),
        (Inventive, "decide_names_an_action_of_the_setting_or_asks"),
        (Late, "decide_follows_the_first_lesson_in_its_situation"),
        (Moody, "the_same_lessons_give_the_same_decisions"),
    ],
)
def test_broken_promise_fails_its_test(learner: LearnerFactory, promise: str) -> None:
    with pytest.raises(AssertionError):
        getattr(Made(learner), f"test_{promise}")()
