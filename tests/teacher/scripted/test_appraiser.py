"""The scripted teacher of all phases: what he says of what he sees, about which picture, how often and how late."""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from behaviors.judges.judge import AppraisalFeatures
from hal.robot import STANDSTILL, GuardResult
from kurt2rt.core.decision.decision import Cause, Decision
from kurt2rt.core.perception.perception import Situation
from kurt2rt.core.rla.rla import MID, Phase
from kurt2rt.core.teaching.commands import Appraise, Command, Resume, Reward, RunBehaviour, SetPhase, Teach
from kurt2rt.core.tick import TickRecord
from kurt2rt.teacher.scripted.appraiser import (
    FeedbackTiming,
    JudgeReward,
    RandomPenalty,
    RewardSource,
    ScriptedAppraiser,
    UnknownPenalty,
)
from tests.core.helpers import sensed
from tests.teacher.scripted.test_teacher import teacher

HABITS = FeedbackTiming(reaction=10, every={-1: 20, 0: 40, 1: 40})
GOOD, NEUTRAL, BAD = 1, 0, -1


class LeftIsTheVerdict:
    """Thinks as a test says: what is left of the robot is its opinion."""

    def judge(self, circumstances: AppraisalFeatures) -> int:
        return int(circumstances.left_m)


def record(tick: int, verdict: int, cause: Cause = Cause.RLA) -> TickRecord:
    """A tick in which RLA 1 drives, or the hand, or nobody."""
    driving = cause in (Cause.RLA, Cause.TEACHER)
    rla_id = 1 if cause is Cause.RLA else None
    circumstances = AppraisalFeatures(*[0.0] * len(AppraisalFeatures._fields))._replace(left_m=float(verdict))
    decision = Decision(STANDSTILL, cause, "a" if driving else None, rla_id, None)
    situation = Situation(np.zeros(1), history_frozen=not driving)
    grant = GuardResult(STANDSTILL, (), latched=False)
    return TickRecord(tick, 0.01 * tick, sensed(100), situation, decision, grant, (), circumstances=circumstances)


def appraiser(phase: Phase, signs: RewardSource | None = None, habits: FeedbackTiming = HABITS) -> ScriptedAppraiser:
    person = ScriptedAppraiser(
        teacher(Phase.SUPERVISED),
        habits,
        signs or JudgeReward(LeftIsTheVerdict()),
        {-1: "bad", 0: "neutral", 1: "good"},
        session="s",
        shown=("a", "b"),
    )
    person.enter(phase)
    return person


def said(person: ScriptedAppraiser, records: Iterable[TickRecord]) -> list[tuple[int, Command]]:
    return [(each.tick, command) for each in records for command in person.watch(each)]


def signals(told: Sequence[tuple[int, Command]]) -> list[tuple[int, int, int | None]]:
    """When, which value and about which tick."""
    return [(tick, each.value, each.decision_tick) for tick, each in told if isinstance(each, Reward)]


def test_what_is_bad_is_said_a_reaction_later_about_the_picture_that_was_meant() -> None:
    person = appraiser(Phase.REINFORCEMENT)
    told = said(person, [record(tick, BAD if tick == 5 else NEUTRAL) for tick in range(1, 40)])
    assert signals(told) == [(15, -1, 5)]
    ((_, reward),) = told
    assert isinstance(reward, Reward)
    assert person.is_signal(reward.command_id)


def test_blame_and_praise_come_no_more_often_than_a_person_speaks() -> None:
    bad = signals(said(appraiser(Phase.REINFORCEMENT), [record(tick, BAD) for tick in range(1, 61)]))
    assert [tick for _, _, tick in bad] == [1, 21, 41]
    good = signals(said(appraiser(Phase.REINFORCEMENT), [record(tick, GOOD) for tick in range(1, 61)]))
    assert [tick for _, _, tick in good] == [1, 41]


def test_a_patient_one_says_nothing_of_what_is_bad_for_a_moment() -> None:
    person = appraiser(Phase.REINFORCEMENT, JudgeReward(LeftIsTheVerdict(), patience=5))
    verdicts = [BAD] * 4 + [NEUTRAL] + [BAD] * 5 + [NEUTRAL] * 10
    told = said(person, [record(tick, verdict) for tick, verdict in enumerate(verdicts, start=1)])
    assert signals(told) == [(20, -1, 10)]


def test_he_blames_no_more_often_than_he_may_and_praises_on() -> None:
    person = appraiser(Phase.REINFORCEMENT, habits=replace(HABITS, most_blame=2))
    bad = [record(tick, BAD) for tick in range(1, 101)]
    good = [record(tick, GOOD) for tick in range(101, 120)]
    assert [value for _, value, _ in signals(said(person, [*bad, *good]))] == [-1, -1, 1]


@pytest.mark.parametrize("cause", [Cause.UNKNOWN, Cause.STOPPED, Cause.TEACHER])
def test_nobody_is_rewarded_where_no_rla_drove(cause: Cause) -> None:
    told = said(appraiser(Phase.REINFORCEMENT), [record(tick, BAD, cause) for tick in range(1, 60)])
    assert signals(told) == []


def test_he_answers_questions_and_corrects_nothing_from_phase_3_on() -> None:
    person = appraiser(Phase.REINFORCEMENT)
    told = said(person, [record(tick, NEUTRAL, Cause.UNKNOWN) for tick in range(1, 101)])
    assert [(tick, type(command)) for tick, command in told] == [(100, Teach)]
    # What the policy would do otherwise, near as it is, is left to signals.
    assert said(person, [record(tick, NEUTRAL) for tick in range(101, 400)]) == []


def test_in_phase_4_he_teaches_the_critic_neutral_things_too_whoever_drives() -> None:
    person = appraiser(Phase.CRITIC)
    seen = [
        *(record(tick, NEUTRAL) for tick in range(1, 31)),
        *(record(tick, GOOD, Cause.TEACHER) for tick in range(31, 61)),
        *(record(tick, BAD, Cause.UNKNOWN) for tick in range(61, 91)),  # it stands, and nothing is done
    ]
    told = [(each.appraisal, each.decision_tick) for _, each in said(person, seen) if isinstance(each, Appraise)]
    assert told == [("neutral", 1), ("good", 31)]


def test_a_gap_holds_for_signals_of_every_kind() -> None:
    person = appraiser(Phase.CRITIC, habits=replace(HABITS, gap=15))
    told = said(person, [record(tick, (BAD, NEUTRAL, GOOD)[tick % 3]) for tick in range(1, 60)])
    meant = [each.decision_tick or 0 for _, each in told if isinstance(each, Appraise)]
    assert len(meant) > 2
    assert all(later - earlier >= 15 for earlier, later in pairwise(meant))


def test_where_it_is_set_down_some_action_is_shown_and_then_it_drives_on() -> None:
    person = appraiser(Phase.CRITIC)
    (shown,) = person.show(7, 20)
    assert isinstance(shown, RunBehaviour)
    assert (shown.action in ("a", "b"), shown.ticks) == (True, 20)
    told = said(person, [record(tick, NEUTRAL, Cause.TEACHER) for tick in range(8, 40)])
    ((tick, resume),) = [(tick, command) for tick, command in told if isinstance(command, Resume)]
    assert tick == 28
    # These are no signals, which may come too late: a refusal must not pass unseen.
    assert not person.is_signal(shown.command_id)
    assert not person.is_signal(resume.command_id)


def test_in_phase_5_nobody_is_there() -> None:
    person = appraiser(Phase.AUTONOMOUS)
    assert not person.answers
    assert said(person, [record(tick, BAD, Cause.UNKNOWN) for tick in range(1, 300)]) == []


def test_where_only_the_unknown_is_bad_what_led_there_is_blamed_once() -> None:
    person = appraiser(Phase.REINFORCEMENT, UnknownPenalty())
    seen = [record(1, BAD), record(2, BAD), *(record(tick, BAD, Cause.UNKNOWN) for tick in range(3, 60))]
    assert signals(said(person, seen)) == [(13, -1, 2)]


def test_where_only_the_unknown_is_bad_nobody_is_blamed_for_a_way_that_the_mid_level_does_not_know() -> None:
    person = appraiser(Phase.REINFORCEMENT, UnknownPenalty())
    asks = record(3, BAD, Cause.UNKNOWN)
    which_way = asks._replace(decision=asks.decision._replace(asks_at=MID))
    assert (
        signals(said(person, [record(1, BAD), record(2, BAD), *(which_way._replace(tick=t) for t in range(3, 60))]))
        == []
    )


def test_blame_by_chance_is_the_same_for_the_same_seed_and_exactly_as_often_as_was_said() -> None:
    def told(seed: int) -> list[tuple[int, int, int | None]]:
        person = appraiser(Phase.REINFORCEMENT, RandomPenalty(50, 5000, 20, seed))
        return signals(said(person, [record(tick, GOOD) for tick in range(1, 5111)]))

    first, other = told(1), told(2)
    assert told(1) == first != other
    assert {value for _, value, _ in first} == {-1}
    assert len(first) == len(other) == 50
    meant = [about or 0 for _, _, about in first]
    assert min(later - earlier for earlier, later in pairwise(meant)) >= 20
    assert [sum(begins < tick <= begins + 2500 for tick in meant) > 10 for begins in (0, 2500)] == [True, True]


def test_blame_by_chance_that_finds_nobody_driving_waits() -> None:
    person = appraiser(Phase.REINFORCEMENT, RandomPenalty(3, 100, 20, 1))
    stands = [record(tick, GOOD, Cause.STOPPED) for tick in range(1, 101)]
    assert signals(said(person, [*stands, *(record(tick, GOOD) for tick in range(101, 200))])) == [
        (111, -1, 101),
        (131, -1, 121),
        (151, -1, 141),
    ]


def test_in_phases_1_and_2_he_is_the_teacher_that_he_was() -> None:
    person = appraiser(Phase.CORRECTIONS)
    assert person.phase is Phase.CORRECTIONS
    assert isinstance(person.enter(Phase.SUPERVISED), SetPhase)
    told = said(person, [record(tick, BAD, Cause.UNKNOWN) for tick in range(1, 101)])
    assert [(tick, type(command)) for tick, command in told] == [(100, Teach)]
