"""Lessons of the critic from a teacher's appraisals of situations."""

import pytest

from behaviors.judges.judge import AppraisalFeatures
from kurt2rt.core.critic.settings import NAMES
from kurt2rt.core.decision.decision import DecisionCause
from kurt2rt.core.outcome import Outcome, RefusalCode, ResultCode
from kurt2rt.core.rla.events import ActionReplaced, Appraised, RlaCreated
from kurt2rt.core.rla.rla import CRITIC, Phase
from kurt2rt.core.teaching.commands import Appraise, CommandResult, ReplaceAction, Reward, Undo
from tests.core.critic.helpers import appraisal
from tests.core.helpers import situation
from tests.core.reinforcement.helpers import CALM, CRASHED, QUICK, Track
from tests.core.rla.helpers import created
from tests.teacher.helpers import delete

NEAR_CALM = CALM._replace(speed_m_s=CALM.speed_m_s + 0.001)


def track(*events: RlaCreated) -> Track:
    return Track(created(1, (0.0,), "a"), *events, phase=Phase.CRITIC)


def appraise(robot: Track, appraisal: str, command_id: str = "x-1", about: int | None = None) -> CommandResult:
    return robot.say(Appraise(command_id, "Ann", appraisal, about))


def test_first_appraisal_creates_a_critic_rla_on_its_tick() -> None:
    robot = track()
    robot.go(0.0, 1, CRASHED)
    meant = robot.tick
    robot.go(0.0, 20, CALM)
    result = appraise(robot, "bad", about=meant)
    assert (result.outcome, result.lesson) == (
        Outcome.of(ResultCode.RLA_TAUGHT, rla=2, level=CRITIC, action="bad"),
        True,
    )
    event = robot.events[-1]
    assert isinstance(event, RlaCreated)
    assert (event.rla.level, event.rla.action, event.rla.condition) == (CRITIC, "bad", tuple(CRASHED)[: len(NAMES)])
    assert len(robot.system) == 1  # nothing at the wheels has changed
    assert robot.critic.appraise(robot.tick + 1, CRASHED) is not None


def test_other_appraisal_replaces_near_and_inserts_far() -> None:
    robot = track(appraisal(2, "good", CALM))
    robot.go(0.0, 1, NEAR_CALM)
    assert appraise(robot, "bad").outcome == Outcome.of(
        ResultCode.RLA_CORRECTED, rla=2, level=CRITIC, action="bad", was="good"
    )
    assert isinstance(robot.events[-1], ActionReplaced)
    far = beyond(robot)
    robot.go(0.0, 1, far)
    assert appraise(robot, "good", "x-2").outcome == Outcome.of(
        ResultCode.RLA_TAUGHT, rla=3, level=CRITIC, action="good"
    )


def beyond(robot: Track) -> AppraisalFeatures:
    """AppraisalFeatures just farther from CALM than another opinion may replace."""
    weight = QUICK.weight_vector[AppraisalFeatures._fields.index("front_m")]
    return CALM._replace(front_m=CALM.front_m - 1.01 * robot.critic.insert_beyond / weight)


def test_equal_appraisal_counts_as_agreement_only() -> None:
    robot = track(appraisal(2, "good", CALM))
    robot.go(0.0, 1, CALM)
    known, heard = robot.hash, robot.agreement.count_for(1)
    result = appraise(robot, "good")
    assert result.outcome == Outcome.of(ResultCode.CRITIC_AGREED, appraisal="good")
    event = robot.events[-1]
    assert isinstance(event, Appraised)
    assert (event.value, event.decided_at_tick) == (1, robot.tick)
    assert robot.hash == known
    assert robot.agreement.count_for(1) == heard + 1


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


def test_an_appraisal_is_undone_corrected_and_deleted_as_any_rla() -> None:
    robot = track(appraisal(2, "good", CALM))
    robot.go(0.0, 1, CRASHED)
    appraise(robot, "bad")
    undone = robot.say(Undo("u-1", "Ann")).outcome
    assert undone.code is ResultCode.LESSON_UNDONE
    assert "RLA 3" in str(undone.fields["says"])
    refused = robot.say(ReplaceAction("p-1", "Ann", 2, "a"))
    known = ("bad", "neutral", "good")
    assert refused.outcome == Outcome.of(RefusalCode.NO_ACTION, action="a", known=known)
    assert robot.say(ReplaceAction("p-2", "Ann", 2, "neutral")).accepted
    assert robot.say(delete(2)).accepted
    assert robot.system.rlas_at(CRITIC) == ()


def test_an_appraisal_does_not_end_the_action_that_is_held() -> None:
    robot = Track(created(1, (0.0,), "a"), created(2, (4.0,), "b"), phase=Phase.CRITIC)
    robot.go(1.0, 2)
    assert appraise(robot, "good").lesson
    assert robot.go(3.0).cause is DecisionCause.HELD
