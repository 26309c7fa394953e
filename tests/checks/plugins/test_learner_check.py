"""Check of learners: promises of holds, and the time of decisions."""

from collections.abc import Iterator

import numpy as np
import pytest
from numpy.typing import NDArray

from kurt2rt.checks.plugins.hold_promises import broken_of_hold_learner
from kurt2rt.checks.plugins.learner_check import check_learner
from kurt2rt.core.learner.learner import LearnerFactory, LearnerSetting, Why
from kurt2rt.experiments.rivals.holds.cloning import BehaviouralCloning
from kurt2rt.experiments.rivals.holds.hold_learner import HoldLearner, actions_of, points_of
from kurt2rt.teacher.scripted.teacher_in_charge import Charge
from tests.core.learner.helpers import SETTING, Parrot

WIDE = SETTING._replace(dimensions=12, weights=np.ones(12), radius=300.0)


class Nearest(HoldLearner):
    """Does what the nearest sample says."""

    charge = Charge.BY_TEACHER
    takes_own_samples = True

    def fit(self) -> None:
        self.points, self.actions = points_of(self.labelled), actions_of(self.labelled)

    def act(self, point: NDArray[np.float64]) -> NDArray[np.float64]:
        preferences = np.zeros(len(self.setting.actions))
        preferences[self.actions[np.linalg.norm(self.points - point, axis=1).argmin()]] = 1.0
        return preferences


class Uncharged(Nearest):
    charge = "teacher"  # type: ignore[assignment]


class Narrow(Nearest):
    def act(self, point: NDArray[np.float64]) -> NDArray[np.float64]:
        return super().act(point)[:2]


class Vague(Nearest):
    def is_ready(self, point: NDArray[np.float64], action: int) -> bool:  # noqa: ARG002 - it looks at nothing
        return None  # type: ignore[return-value]


class Silent(Nearest):
    charge = Charge.BY_ROBOT


class Proud(Nearest):
    def lesson(self, situation: NDArray[np.float64], action: str, why: Why) -> None:
        if why is Why.OVERRULED:
            raise ValueError("never")
        super().lesson(situation, action, why)


class Hasty(Nearest):
    def lesson(self, situation: NDArray[np.float64], action: str, why: Why) -> None:
        super().lesson(situation, action, why)
        self.refit()


class Charged(Parrot):
    charge = Charge.ALWAYS


@pytest.mark.parametrize("kept", [Nearest, BehaviouralCloning, Parrot])
def test_learner_that_keeps_the_promises_of_holds_passes(kept: LearnerFactory) -> None:
    assert broken_of_hold_learner(kept, WIDE) == []


@pytest.mark.parametrize(
    ("learner", "promise"),
    [
        (Uncharged, "`charge` is one of Charge.ALWAYS, Charge.NAMES, Charge.BY_TEACHER, Charge.BY_ROBOT: it is 'teach"),
        (Narrow, "`act` returns one finite preference for each action: it does not"),
        (Vague, "`asks` and `is_ready` return True or False: it does not"),
        (Silent, "with Charge.BY_ROBOT, `asks` and `is_ready` are its own: it does not"),
        (Proud, "it takes samples of its own drives, if `takes_own_samples` says so: raised ValueError: never ("),
        (Hasty, "lessons change no decision between two fits of a run: it does not"),
        (Charged, "a learner with `charge` is a subclass of HoldLearner: it is a Charged"),
    ],
)
def test_broken_promise_of_holds_is_named(learner: LearnerFactory, promise: str) -> None:
    first, *_ = check_learner(learner, WIDE).broken
    assert first.startswith(promise)


def taking(milliseconds: float) -> Iterator[int]:
    """Yield times in ns of a clock that goes on by so much in each decision, and fifty times that in the first."""
    now_ns = 0
    for place in range(1_000):
        yield now_ns
        yield (now_ns := now_ns + round(milliseconds * 1e6) * (50 if place == 0 else 1))


@pytest.mark.parametrize(
    ("milliseconds", "told"),
    [
        (0.25, "decide takes 0.25 ms in the median and 0.25 ms at most after 40 lessons, and 12 ms when it is first"),
        (30.0, "warning: decide takes 30 ms in the median and 30 ms at most after 40 lessons, and 1500 ms when it is"),
    ],
)
def test_time_to_decide_is_told_in_words(milliseconds: float, told: str) -> None:
    broken, note = check_learner(_Nearby, WIDE, taking(milliseconds).__next__)
    assert broken == []
    assert note.startswith(told)
    assert ("so a robot would stand" in note) == (milliseconds > 20.0)


class _Nearby:
    """Parrot that keeps the promises in any number of dimensions."""

    def __init__(self, setting: LearnerSetting) -> None:
        self._parrot = Parrot(setting._replace(dimensions=1))
        self.decide, self.lesson = self._parrot.decide, self._parrot.lesson
        self.snapshot, self.restore = self._parrot.snapshot, self._parrot.restore
