"""Lessons of the critic from a teacher's appraisals of situations."""

import pytest

from kurt2rt.core.decision.decision import DecisionCause
from kurt2rt.core.outcome import Outcome, RefusalCode, ResultCode
from kurt2rt.core.rla.events import RlaCreated
from kurt2rt.core.rla.rla import Phase
from kurt2rt.core.teaching.commands import Appraise, CommandResult, Reward
from tests.core.critic.helpers import appraisal
from tests.core.helpers import situation
from tests.core.reinforcement.helpers import CALM, CRASHED, Track
from tests.core.rla.helpers import created


def track(*events: RlaCreated) -> Track:
    return Track(created(1, (0.0,), "a"), *events, phase=Phase.CRITIC)


def appraise(robot: Track, appraisal: str, command_id: str = "x-1", about: int | None = None) -> CommandResult:
    return robot.say(Appraise(command_id, "Ann", appraisal, about))


def test_opinion_learnt_after_the_tick_is_no_agreement() -> None:
    """Two clicks on the same mishap: the second one must not count as if the critic had known."""
    robot = track(appraisal(2, "good", CALM))
    robot.go(0.0, 10, CRASHED)
    first, second = robot.tick - 5, robot.tick
    appraise(robot, "bad", "x-1", first)
    result = appraise(robot, "bad", "x-2", second)
    assert (result.outcome, result.lesson) == (Outcome.of(ResultCode.CRITIC_AGREES, appraisal="bad"), False)
    assert robot.agreement.count_for(-1) == 1


def test_a_reward_tells_what_the_critic_had_said_of_that_tick() -> None:
    robot = track(appraisal(2, "bad", CRASHED))
    robot.go(0.0, 1, CRASHED)
    meant = robot.tick
    robot.go(0.0, 1, CALM)
    robot.say(Reward("r-1", "Ann", 1, meant))
    appraise(robot, "good", "x-1", meant)  # what it learns afterwards does not change what it had said
    assert [getattr(event, "said", None) for event in robot.events[-2:-1]] == [-1]


@pytest.mark.parametrize("meant", [0, 1, 500])
def test_a_tick_that_is_not_remembered_is_refused(meant: int) -> None:
    robot = track()
    robot.go(0.0, 1)
    robot.tick += 1  # missed
    robot.go(0.0, 1)
    assert appraise(robot, "good", about=meant + 1 if meant else 0).accepted == (meant == 2)


def test_appraisal_of_a_blind_tick_is_refused() -> None:
    robot = track()
    decision = robot.level.decide(situation(0.0), None, DecisionCause.BLIND)  # type: ignore[arg-type] # it stands
    robot.recent.add(robot.tick + 1, None, decision)
    robot.tick += 1
    result = appraise(robot, "bad")
    assert result.outcome == Outcome(RefusalCode.WAS_BLIND)
