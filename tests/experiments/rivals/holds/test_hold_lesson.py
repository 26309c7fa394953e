"""Lessons with a teacher in charge on the simulated robot."""

from contextlib import closing
from dataclasses import dataclass

import anyio
import pytest

from kurt2rt.core.learner.learner import Why
from kurt2rt.core.learner.learner_team import LearnerTeam
from kurt2rt.core.task_settings import taught_by
from kurt2rt.core.teacher_settings import load_teacher
from kurt2rt.experiments.rivals.holds.hold_learner import HoldLearner
from kurt2rt.experiments.rivals.holds.lesson import FitTimes, teach_by_holds
from kurt2rt.experiments.rivals.holds.rows import HELD
from kurt2rt.experiments.rivals.learner_clock import LearnerClock, untimed
from kurt2rt.experiments.rivals.lesson import RivalLesson, RivalSetup
from kurt2rt.experiments.rivals.rival import Rival
from tests.experiments.helpers import ROBOT, STAGE, short_task

TASK = taught_by(short_task(10.0, 10.0), load_teacher("ordinary"))
TIMES = FitTimes(first_s=5.0, every_s=5.0)


@dataclass(frozen=True)
class Done:
    lesson: RivalLesson
    team: LearnerTeam | None
    clock: LearnerClock

    @property
    def learner(self) -> HoldLearner:
        assert self.team is not None
        learner = untimed(self.team.learner(""))
        assert isinstance(learner, HoldLearner)
        return learner

    def labels(self, why: Why) -> int:
        assert self.team is not None
        return sum(label.why is why for label in self.team.labels)


def lesson_by(name: str, seed: int = 3905) -> Done:
    rival, clock = Rival(name), LearnerClock()
    team = rival.new_team(TASK, ROBOT, seed, clock.timed(rival.factory())) if rival.is_learner else None

    async def teach() -> RivalLesson:
        with closing(STAGE.open("a", seed, "lesson")) as simulation:
            setup = RivalSetup(robot=ROBOT, task=TASK, seed=seed, team=team, after=(1,))
            return await teach_by_holds(simulation, setup, clock, lambda _: None, TIMES)

    return Done(anyio.run(teach), team, clock)


def test_teacher_of_bc_drives_for_the_whole_lesson() -> None:
    done = lesson_by("bc")
    assert done.lesson.result.presses == 1
    assert done.lesson.driven_s + done.lesson.waited_s == pytest.approx(20.0)
    assert done.learner.iteration == 0
    assert 100 < done.labels(Why.HOLD) <= 10 * done.lesson.driven_s + 3


def test_dagger_labels_all_that_it_meets() -> None:
    done = lesson_by("dagger")
    assert done.lesson.result.presses == 1
    assert done.lesson.result.asks == 1
    assert done.learner.iteration == 3
    assert done.labels(Why.HOLD) == pytest.approx(10 * done.lesson.driven_s, abs=10)


def test_teacher_of_iwr_gives_the_robot_back_and_lets_it_learn() -> None:
    done = lesson_by("iwr")
    assert TIMES.first_s <= done.lesson.driven_s < 19.0
    assert done.learner.iteration >= 1
    assert done.clock.retraining_s > 0.0
    assert done.labels(Why.DROVE) > 10


@pytest.mark.deep
def test_same_seed_gives_the_same_lesson() -> None:
    first, second = lesson_by("safe-dagger"), lesson_by("safe-dagger")
    first_labels, second_labels = first.lesson.marks[-1].lessons, second.lesson.marks[-1].lessons
    assert [each[2] for each in first_labels] == [each[2] for each in second_labels]
    assert first.lesson.result.press_ticks == second.lesson.result.press_ticks


def test_rla_system_in_charge_is_given_back_at_once() -> None:
    done = lesson_by(HELD)
    assert done.lesson.driven_s < 18.0
    assert len(done.lesson.result.rlas) > 5
    assert done.lesson.result.presses >= 1
