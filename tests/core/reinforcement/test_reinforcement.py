"""Rewards, values and repairs in whole ticks."""

import pytest

from kurt2rt.core.rla.events import ActionWithdrawn, RlaRewarded
from kurt2rt.core.rla.rla import Phase
from kurt2rt.core.rla.statistics import VALUES_INCLUDE, Statistics
from kurt2rt.core.teaching.commands import Undo
from tests.core.reinforcement.helpers import SIGNALS_ONLY, Track, deleted_ids
from tests.core.rla.helpers import created
from tests.teacher.helpers import correct

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
