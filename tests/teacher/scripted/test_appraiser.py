"""ScriptedAppraiser: signals, their ticks, their rate and their delay."""

from collections.abc import Iterable, Sequence
from dataclasses import replace

from behaviors.judges.judge import AppraisalFeatures
from hal.robot import STANDSTILL
from hal.robot_settings import load_robot
from kurt2rt.core.decision.decision import Decision, DecisionCause
from kurt2rt.core.rla.rla import Phase
from kurt2rt.core.task_settings import load_task, taught_by
from kurt2rt.core.teacher_settings import load_teacher
from kurt2rt.core.teaching.commands import Command, Resume, Reward, RunBehaviour, Teach
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.teacher.scripted.appraiser import (
    FeedbackTiming,
    JudgeReward,
    RewardSource,
    ScriptedAppraiser,
    UnknownPenalty,
)
from kurt2rt.teacher.scripted.basic_teacher import BasicTeacher
from kurt2rt.teacher.scripted.build import build_teacher
from tests.teacher.scripted.test_teacher import record_of, teacher

ROBOT = load_robot()
TASK = taught_by(load_task("wall_following"), load_teacher("ordinary"))
TIMING = FeedbackTiming(reaction=10, every={-1: 20, 0: 40, 1: 40})
NEUTRAL, BAD = 0, -1


class LeftIsTheVerdict:
    """Judge whose value is the distance to the left."""

    def judge(self, circumstances: AppraisalFeatures) -> int:
        return int(circumstances.left_m)


def record(tick: int, verdict: int, cause: DecisionCause = DecisionCause.RLA) -> TickRecord:
    """Return a tick with the judge's value, in which RLA 1 or the teacher drives or the robot stands."""
    driving = cause in (DecisionCause.RLA, DecisionCause.TEACHER)
    rla_id = 1 if cause is DecisionCause.RLA else None
    circumstances = AppraisalFeatures(*[0.0] * len(AppraisalFeatures._fields))._replace(left_m=float(verdict))
    decision = Decision(STANDSTILL, cause, "a" if driving else None, rla_id, None)
    return record_of(decision, tick=tick, appraisal_features=circumstances)


def appraiser(
    phase: Phase,
    rewards: RewardSource | None = None,
    timing: FeedbackTiming = TIMING,
    answering: BasicTeacher | None = None,
) -> ScriptedAppraiser:
    person = ScriptedAppraiser(
        answering or teacher(Phase.SUPERVISED),
        timing,
        rewards or JudgeReward(LeftIsTheVerdict()),
        {-1: "bad", 0: "neutral", 1: "good"},
        session="s",
        demonstrated=("a", "b"),
    )
    person.begin_phase(phase)
    return person


def given(person: ScriptedAppraiser, records: Iterable[TickRecord]) -> list[tuple[int, Command]]:
    return [(each.tick, command) for each in records for command in person.on_tick(each)]


def signals(commands: Sequence[tuple[int, Command]]) -> list[tuple[int, int, int | None]]:
    """Return (tick of the reward, value, rewarded tick) of each reward."""
    return [(tick, each.value, each.decision_tick) for tick, each in commands if isinstance(each, Reward)]


def test_reward_comes_a_reaction_later_for_the_judged_tick() -> None:
    person = appraiser(Phase.REINFORCEMENT)
    commands = given(person, [record(tick, BAD if tick == 5 else NEUTRAL) for tick in range(1, 40)])
    assert signals(commands) == [(15, -1, 5)]
    ((_, reward),) = commands
    assert isinstance(reward, Reward)
    assert person.may_be_refused(reward.command_id)


def test_press_that_a_person_has_not_left_is_no_punishment() -> None:
    answering = build_teacher(TASK, ROBOT, ("forward",), seed=1, session="s")
    person = appraiser(Phase.REINFORCEMENT, timing=replace(TIMING, max_punishments=20), answering=answering)
    given_ticks = [tick for tick, _, _ in signals(given(person, [record(tick, BAD) for tick in range(1, 8001)]))]
    # Twelve presses a minute: the next ones come as soon as the first are a minute old, and then the limit ends them.
    assert len([tick for tick in given_ticks if tick <= 6000]) == 12
    assert len(given_ticks) == 20


def test_phase_3_answers_and_does_not_correct() -> None:
    person = appraiser(Phase.REINFORCEMENT)
    commands = given(person, [record(tick, NEUTRAL, DecisionCause.UNKNOWN) for tick in range(1, 101)])
    assert [(tick, type(command)) for tick, command in commands] == [(100, Teach)]
    assert given(person, [record(tick, NEUTRAL) for tick in range(101, 400)]) == []


def test_demonstrate_runs_an_action_then_resumes() -> None:
    person = appraiser(Phase.CRITIC)
    (shown,) = person.demonstrate(7, 20)
    assert isinstance(shown, RunBehaviour)
    assert (shown.action in ("a", "b"), shown.ticks) == (True, 20)
    commands = given(person, [record(tick, NEUTRAL, DecisionCause.TEACHER) for tick in range(8, 40)])
    ((tick, resume),) = [(tick, command) for tick, command in commands if isinstance(command, Resume)]
    assert tick == 28
    # Only signals may be refused as too late; a refusal of these must be seen.
    assert not person.may_be_refused(shown.command_id)
    assert not person.may_be_refused(resume.command_id)


def test_unknown_penalty_is_given_once_for_the_tick_before() -> None:
    person = appraiser(Phase.REINFORCEMENT, UnknownPenalty())
    seen = [record(1, BAD), record(2, BAD), *(record(tick, BAD, DecisionCause.UNKNOWN) for tick in range(3, 60))]
    assert signals(given(person, seen)) == [(13, -1, 2)]
