"""Learners of rewards do what their papers say, and are taught by rewards alone."""

from contextlib import closing

import anyio
import numpy as np
import pytest

from hal.settings import SettingsError
from kurt2rt.core.learner.learner import Driven, LearnerSetting
from kurt2rt.core.task_settings import TaskSettings, load_task
from kurt2rt.experiments.phases.steps import reward_plan
from kurt2rt.experiments.rivals.lesson import RivalLesson, RivalSetup, teach_rival
from kurt2rt.experiments.rivals.rival import Rival
from kurt2rt.experiments.rivals.signals.coach import Coach
from kurt2rt.experiments.rivals.signals.deep_tamer import DeepTamer
from kurt2rt.experiments.rivals.signals.reward_learner import RewardLearner
from kurt2rt.experiments.rivals.signals.rows import REWARDED, TARGETS
from kurt2rt.experiments.rivals.signals.tamer import CREDIT_TICKS, Tamer
from tests.experiments.helpers import ROBOT, STAGE, short_task

SETTING = LearnerSetting(2, np.ones(2), 10.0, 0.5, 0.1, ("a", "b", "c"), 1)
HERE, THERE = np.array([10.0, 0.0]), np.array([0.0, 10.0])
LEARNERS = (Tamer, DeepTamer, Coach)


def lesson_by(name: str, task: TaskSettings) -> RivalLesson:
    rival = Rival(name)
    team = rival.new_team(task, ROBOT, 3920) if rival.is_learner else None
    plan = reward_plan(task, task.teaching.duration_s, "lesson")

    async def teach() -> RivalLesson:
        with closing(STAGE.open(task.teaching.world, 3920, "lesson")) as simulation:
            setup = RivalSetup(robot=ROBOT, task=task, seed=3920, team=team, after=(1,))
            return await teach_rival(simulation, setup, lambda _: None, plan)

    return anyio.run(teach)


@pytest.mark.parametrize("kind", LEARNERS)
def test_action_that_is_rewarded_in_its_situation_wins(kind: type[RewardLearner]) -> None:
    learner = kind(SETTING)
    for _ in range(60):
        for situation, good in ((HERE, "b"), (THERE, "c")):
            for action in SETTING.actions:
                learner.signal([Driven(situation, action, 0)], 1 if action == good else -1)
    assert (learner.decide(HERE, taught=False), learner.decide(THERE, taught=False)) == ("b", "c")


def test_tamer_moves_its_model_towards_the_reward() -> None:
    tamer = Tamer(SETTING)
    tamer.signal([Driven(HERE, "a", 0), Driven(THERE, "b", CREDIT_TICKS)], -1)
    features = tamer.features(HERE)
    # Normalised gradient descent: a fifth of the error of -1 is taken away; what is too old gets no credit.
    assert tamer.preferences(features, taught=True) == pytest.approx([-0.2, 0.0, 0.0])
    assert tamer.preferences(tamer.features(THERE), taught=True)[1] == 0.0
    tamer.signal([Driven(HERE, "a", 0)], -1)
    assert tamer.preferences(features, taught=True)[0] == pytest.approx(-0.36)


def test_coach_follows_the_gradient_of_its_policy() -> None:
    coach = Coach(SETTING)
    features = coach.features(HERE)

    def log_probability(policy: Coach) -> float:
        preferences = policy.preferences(features, taught=False)
        return float(preferences[0] - np.log(np.exp(preferences).sum()))

    before = log_probability(coach)
    coach.signal([Driven(HERE, "a", 0)], 1)
    # d log pi / d w_a = (1 - pi) phi, and -pi phi for each other action: pi is 1/3 at first.
    step = 0.5 * 0.05 * float(features @ features)
    changed = coach.preferences(features, taught=False)
    assert changed == pytest.approx([step * 2 / 3, -step / 3, -step / 3])
    assert log_probability(coach) > before


def test_coach_draws_by_situation_and_equally_twice() -> None:
    coach = Coach(SETTING)
    places = [np.array([float(place), 1.0]) for place in range(60)]
    drawn = [coach.decide(place, taught=True) for place in places]
    assert set(drawn) == set(SETTING.actions)
    assert drawn == [coach.decide(place, taught=True) for place in places]
    assert {coach.decide(place, taught=False) for place in places} == {"a"}


def test_robot_is_taught_by_rewards_alone() -> None:
    lesson = lesson_by("tamer", short_task(5.0, 4.0))
    assert lesson.result.asks == 0
    assert lesson.result.corrections == 0
    signals = lesson.marks[-1].lessons
    assert len(signals) == lesson.result.positive_rewards + lesson.result.negative_rewards > 3


def test_rla_system_is_answered_and_rewarded() -> None:
    lesson = lesson_by(REWARDED, short_task(5.0, 4.0))
    assert lesson.result.asks > 0
    assert lesson.result.corrections == 0


def test_task_without_a_judge_has_no_such_lesson() -> None:
    with pytest.raises(SettingsError, match="phases"):
        lesson_by("tamer", load_task("streets"))


def test_each_learner_is_taught_by_rewards() -> None:
    assert all(Rival(name).is_rewarded for name in TARGETS)
    assert not Rival("k-nn").is_rewarded
