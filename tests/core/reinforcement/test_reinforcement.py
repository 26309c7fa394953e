"""Rewards, values and repairs in whole ticks."""

import pytest

from kurt2rt.core.decision.decision import DecisionCause
from kurt2rt.core.outcome import Outcome, RefusalCode, ResultCode
from kurt2rt.core.rla.events import ActionWithdrawn, RlaCreated, RlaDeleted, RlaRewarded
from kurt2rt.core.rla.rla import Phase
from kurt2rt.core.rla.statistics import VALUES_INCLUDE, Statistics
from kurt2rt.core.teaching.commands import DeleteRla, Reward, Teach, Undo
from tests.core.helpers import MINIMUM_TICKS, RADIUS
from tests.core.reinforcement.helpers import CALM, SHARE, SIGNALS_ONLY, Track, deleted_ids, knows_good_from_bad
from tests.core.rla.helpers import created
from tests.teacher.helpers import correct, teach

LEFT, RIGHT = 0.0, 50.0
KNOWN = (created(1, (LEFT,), "a"), created(2, (RIGHT,), "b"))


def track(*, phase: Phase = Phase.REINFORCEMENT, saved: Statistics | None = None) -> Track:
    return Track(*KNOWN, reinforcement=SIGNALS_ONLY, phase=phase, saved=saved)


def saved_values(values: dict[int, float], rows: int) -> Statistics:
    """Return values as they are after so many lessons."""
    return Statistics(values=values, numbers={VALUES_INCLUDE: float(rows)})


def sink(robot: Track, place: float, times: int = 3) -> None:
    """Drive long in one place, and be blamed for it."""
    for _ in range(times):
        robot.go(place, 400)
        robot.signal(-1)


def shares(event: RlaRewarded) -> dict[int, float]:
    """Return the credit of each RLA."""
    return {credit.rla_id: credit.change for credit in event.credits}


def test_reward_credits_those_that_drove() -> None:
    robot = track()
    robot.go(LEFT, 400)
    robot.go(RIGHT, 20)
    event = robot.signal(1)
    assert (event.rla_id, event.value, event.decided_at_tick) == (2, 1, robot.tick)
    credits_ = shares(event)
    assert credits_.keys() == {1, 2}
    assert sum(credits_.values()) == pytest.approx(0.3, abs=0.002)
    assert (robot.value(1), robot.value(2)) == pytest.approx((0.5 + credits_[1], 0.5 + credits_[2]))


def test_reward_asking_or_standing_credits_none() -> None:
    robot = track()
    robot.go(LEFT, 100)
    asked = robot.go(25.0)
    assert asked.asking
    refused = robot.say(Reward("r-1", "Ann", -1, robot.tick))
    assert refused.outcome == Outcome(RefusalCode.NO_RLA_DROVE)
    robot.go(LEFT, because=DecisionCause.STOPPED)
    assert not robot.say(Reward("r-2", "Ann", -1, robot.tick)).accepted
    assert (robot.value(1), robot.value(2)) == (0.5, 0.5)


def test_reward_held_action_outside_radius_has_no_share() -> None:
    """The minimum time of an action carries it out of its radius, into that of another."""
    robot = track()
    robot.go(LEFT)
    held = robot.go(RIGHT)
    assert (held.cause, held.rla_id, held.answers) == (DecisionCause.HELD, 1, False)
    refused = robot.say(Reward("r-1", "Ann", -1, robot.tick))
    assert refused.outcome == Outcome.of(RefusalCode.OUTSIDE_RADIUS, rla=1)
    robot.go(RIGHT, MINIMUM_TICKS)
    assert shares(robot.signal(-1)).keys() == {1, 2}  # for the tick in which it was known, and its own


def test_undo_subtracts_exactly_the_credits() -> None:
    robot = track()
    robot.go(LEFT, 400)
    robot.go(RIGHT, 20)
    blame = robot.signal(-1)
    robot.go(RIGHT, 400)
    robot.signal(1)
    before = (robot.value(1), robot.value(2))
    robot.go(LEFT, 400)
    praise = robot.signal(1)
    assert robot.say(Undo("u-1", "Ann", praise.origin.command_id)).accepted
    assert (robot.value(1), robot.value(2)) == pytest.approx(before)
    assert robot.say(Undo("u-2", "Ann")).accepted
    assert robot.say(Undo("u-3", "Ann", blame.origin.command_id)).accepted
    assert (robot.value(1), robot.value(2)) == pytest.approx((0.5, 0.5))


def test_reward_after_correction_skips_the_old_action() -> None:
    robot = track()
    robot.go(LEFT, 100)
    wrong = robot.tick
    robot.say(correct("c", "c-1"), LEFT)
    robot.go(LEFT, 10)
    assert robot.signal(-1, wrong).credits == ()
    assert robot.value(1) == 0.5


def test_punished_rla_is_withdrawn_and_asks_next_tick() -> None:
    robot = track()
    sink(robot, LEFT)
    assert robot.value(1) < -0.2
    at_blame = robot.go(LEFT)  # the tick that took the blame had decided already
    (event,) = robot.learnt
    assert isinstance(event, ActionWithdrawn)
    assert (event.rla_id, event.instead_of) == (1, "a")
    assert (event.origin.command_id, event.origin.teacher) == ("signal-3/withdraw-1", "Ann")
    assert at_blame.driving
    after = robot.go(LEFT)
    assert (after.driving, after.asking) == (False, True)
    assert not robot.go(RIGHT).asking


def test_answer_to_withdrawn_rla_acts_next_tick() -> None:
    robot = track()
    sink(robot, LEFT)
    robot.go(LEFT, 2)
    robot.go(LEFT + SHARE * RADIUS)
    assert robot.say(Teach("t-1", "Ann", "c", robot.tick)).outcome == Outcome.of(
        ResultCode.RLA_ANSWERED, rla=1, action="c"
    )
    assert robot.actions == {1: "c", 2: "b"}
    assert robot.value(1) == 0.5
    decision = robot.go(LEFT)
    assert (decision.driving, decision.action) == (True, "c")


@pytest.mark.parametrize("phase", [Phase.SUPERVISED, Phase.CRITIC])
def test_punishment_counts_in_phases_1_to_4(phase: Phase) -> None:
    robot = track(phase=phase)
    sink(robot, LEFT)
    robot.go(LEFT)
    assert [type(event) for event in robot.learnt] == [ActionWithdrawn]
    assert robot.learnt[0].origin.phase is phase


@pytest.mark.parametrize(("phase", "learns"), [(1, False), (2, False), (3, True), (4, True), (5, False)])
def test_td_steps_only_in_phases_with_signals(phase: int, learns: bool) -> None:
    robot = Track(*KNOWN, reinforcement=SIGNALS_ONLY.model_copy(update={"step_s": 0.1}), phase=Phase(phase))
    robot.go(LEFT, 400)
    assert (robot.value(1) < 0.5) == learns


def test_phase_5_competitor_takes_neighbours_action() -> None:
    robot = track(phase=Phase.AUTONOMOUS)
    sink(robot, LEFT)
    robot.go(LEFT)
    (event,) = robot.learnt
    assert isinstance(event, RlaCreated)
    assert (event.rla.condition, event.rla.action, event.rla.rla_id) == ((LEFT,), "b", 3)
    decision = robot.go(LEFT)
    assert (decision.action, decision.rla_id) == ("b", 3)


def test_low_competitor_of_a_better_one_is_deleted() -> None:
    robot = track(phase=Phase.AUTONOMOUS)
    sink(robot, LEFT)
    robot.go(LEFT, 10)
    robot.reinforcement.choice.reset()
    robot.reinforcement.rule.restore(Statistics(values={1: 0.0, 3: -0.1}))
    sink(robot, LEFT, times=1)  # the first one answers again, and is blamed again
    robot.go(LEFT)
    assert deleted_ids(robot.learnt) == [1]
    assert robot.actions == {2: "b", 3: "b"}


def test_phase_5_enough_tries_delete_all_competitors() -> None:
    settings = SIGNALS_ONLY.model_copy(update={"most_competitors": 1})
    robot = Track(*KNOWN, created(3, (5.0,), "c"), reinforcement=settings, phase=Phase.AUTONOMOUS)
    sink(robot, LEFT)
    robot.go(LEFT)
    assert robot.actions == {1: "a", 2: "b", 3: "c", 4: "c"}
    robot.go(LEFT, 1000)  # until the first one has no part in what comes
    sink(robot, LEFT)
    robot.go(LEFT)
    assert deleted_ids(robot.learnt) == [1, 4]
    assert robot.go(LEFT).rla_id == 3


def test_competitors_with_teacher_are_deleted_last_asks() -> None:
    saved = saved_values({1: 0.0, 2: -0.1}, 2)
    robot = Track(created(1, (LEFT,), "a"), created(2, (LEFT,), "b"), reinforcement=SIGNALS_ONLY, saved=saved)
    sink(robot, LEFT, times=1)
    robot.go(LEFT)
    assert deleted_ids(robot.learnt) == [1]
    robot.go(LEFT, 400)
    sink(robot, LEFT, times=1)
    robot.go(LEFT)
    assert [type(event) for event in robot.learnt] == [ActionWithdrawn]
    assert robot.go(LEFT).asking


def whole_story(seed: int) -> Track:
    """Blamed at every turn, with chance at work."""
    settings = SIGNALS_ONLY.model_copy(update={"step_s": 0.1, "epsilon": 0.3, "hold_s": 0.05, "seed": seed})
    events = [created(n, (4.0 * n,), "abc"[n % 3]) for n in range(1, 12)]
    robot = Track(*events, reinforcement=settings, phase=Phase.AUTONOMOUS)
    robot.agreement._signals[1].extend([("x", True)] * 5)
    robot.agreement._signals[-1].extend([("x", True)] * 5)
    for turn in range(60):
        robot.go(4.0 * (turn * 7 % 12), 60)
        if robot.recent.answering_rla(robot.tick):
            robot.signal(-1 if turn % 3 else 1)
    return robot


def test_same_seed_gives_same_knowledge_and_values() -> None:
    one, again = whole_story(1), whole_story(1)
    assert len(one.events) > 60
    assert one.events == again.events
    assert one.hash == again.hash
    assert one.reinforcement.rule.values == again.reinforcement.rule.values


def test_all_changes_can_be_undone() -> None:
    robot = whole_story(1)
    assert any(isinstance(event, RlaDeleted) for event in robot.events)
    first = Track(*(created(n, (4.0 * n,), "abc"[n % 3]) for n in range(1, 12)))
    while len(robot.system.lessons) and robot.system.standing_lessons > 11:
        assert robot.say(Undo(f"undo-{robot.system.standing_lessons}", "Ann")).accepted
    assert robot.hash == first.hash


def test_restore_without_values_uses_credits() -> None:
    robot = track()
    robot.go(LEFT, 400)
    robot.go(RIGHT, 20)
    robot.signal(-1)
    robot.go(LEFT, 400)
    robot.signal(1)
    robot.say(correct("c", "c-1"), LEFT)
    robot.signal(1, robot.tick)
    again = Track(*robot.events, reinforcement=SIGNALS_ONLY)
    assert [again.value(n) for n in (1, 2)] == pytest.approx([robot.value(n) for n in (1, 2)])
    rewards = [event for event in robot.events if isinstance(event, RlaRewarded)]
    for run in (robot, again):
        assert run.say(Undo("u-1", "Ann", rewards[0].origin.command_id)).accepted
    assert [again.value(n) for n in (1, 2)] == pytest.approx([robot.value(n) for n in (1, 2)])
    assert again.learnt == []
    again.go(LEFT)
    assert again.learnt == []  # blame of an earlier run was looked at then


def test_restore_adds_credits_after_the_checkpoint() -> None:
    robot = track()
    robot.go(LEFT, 400)
    robot.signal(-1)
    saved = robot.reinforcement.snapshot()
    robot.go(LEFT, 400)
    robot.signal(-1)
    robot.go(RIGHT, 400)
    robot.signal(-1)
    robot.say(correct("c", "c-1"), RIGHT)
    again = track_with(robot, saved)  # nothing was saved after that
    assert [again.value(n) for n in (1, 2)] == pytest.approx([robot.value(n) for n in (1, 2)])
    assert again.reinforcement.snapshot() == robot.reinforcement.snapshot()
    for run in (robot, again):
        for lesson in ("c-1", "signal-3", "signal-2", "signal-1"):
            assert run.say(Undo(f"u-{lesson}", "Ann", lesson)).accepted
    assert [again.value(n) for n in (1, 2)] == pytest.approx([0.5, 0.5])


def track_with(robot: Track, saved: Statistics) -> Track:
    return Track(*robot.events, reinforcement=SIGNALS_ONLY, saved=saved)


STEPS = SIGNALS_ONLY.model_copy(update={"step_s": 0.1})
NEUTRAL = CALM._replace(front_m=0.30, speed_m_s=5.0)


def test_autonomous_values_end_with_phase_5() -> None:
    robot = Track(*KNOWN, *knows_good_from_bad(), reinforcement=STEPS, phase=Phase.AUTONOMOUS)
    while robot.value(1) > 0.3:  # unpraised, values sink
        robot.go(LEFT, 100, NEUTRAL)
    assert robot.reinforcement.rule.values == {}
    robot.school.phase = Phase.REINFORCEMENT
    robot.go(LEFT)
    assert robot.value(1) == 0.5
    robot.school.phase = Phase.AUTONOMOUS
    robot.go(LEFT)
    assert robot.value(1) == 0.5  # each phase 5 starts from the first value


def test_phase_5_teachers_reward_changes_both_values() -> None:
    robot = track(phase=Phase.AUTONOMOUS)
    robot.go(LEFT, 400)
    blame = robot.signal(-1)
    assert shares(blame)[1] == pytest.approx(-0.3, abs=0.002)
    assert robot.value(1) == robot.reinforcement.rule.value(1) == pytest.approx(0.2, abs=0.002)
    then = robot.reinforcement.autonomous_values()
    robot.go(LEFT, 400)
    robot.signal(1)
    robot.reinforcement.restore_autonomous(then, {1})
    assert robot.value(1) == pytest.approx(0.2, abs=0.002)
    assert robot.reinforcement.rule.value(1) == pytest.approx(0.5, abs=0.002)  # the teacher's stays
    assert robot.say(Undo("u-1", "Ann", robot.events[-1].origin.command_id)).accepted
    assert robot.say(Undo("u-2", "Ann", blame.origin.command_id)).accepted
    assert robot.reinforcement.rule.value(1) == pytest.approx(0.5)
    robot.school.phase = Phase.REINFORCEMENT
    robot.go(LEFT)
    assert robot.value(1) == pytest.approx(0.5)
    assert robot.reinforcement.autonomous_values() == Statistics()


def test_undone_creation_is_dropped_deletion_is_kept() -> None:
    robot = Track(*KNOWN, reinforcement=SIGNALS_ONLY)

    def kept() -> set[int]:
        return {*robot.reinforcement.snapshot().values}

    assert robot.say(teach("c", "t-1"), 20.0).accepted
    for place in (LEFT, RIGHT, 20.0):
        robot.go(place, 20)
    robot.signal(-1)
    worth = robot.value(3)
    assert 3 in kept()
    assert robot.say(DeleteRla("d-1", "Ann", 3)).accepted
    assert 3 not in kept()
    robot.signal(-1, robot.tick - 21)  # the tick before; a tick in which it drove has no share
    assert 3 not in kept()
    assert robot.say(Undo("u-1", "Ann", "d-1")).accepted
    assert robot.value(3) == pytest.approx(worth)
    assert robot.say(Undo("u-2", "Ann", "signal-1")).accepted
    assert robot.say(Undo("u-3", "Ann", "t-1")).accepted
    assert 3 not in kept()
    assert robot.say(Undo("u-4", "Ann", "signal-2")).accepted  # its credits are not put on what is no more
    assert 3 not in kept()


def test_restore_drops_values_of_deleted_rlas() -> None:
    robot = track(saved=saved_values({1: 0.25, 77: -0.5}, 3))
    assert robot.reinforcement.snapshot().values == {1: 0.25}
