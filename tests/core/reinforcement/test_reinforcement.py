"""Rewards as stories: who is blamed, what sinks, what is asked again, and what an undo leaves."""

import pytest

from kurt2rt.core.decision.decision import Cause
from kurt2rt.core.outcome import Outcome, RefusalCode, ResultCode
from kurt2rt.core.reinforcement.settings import ReinforcementSettings
from kurt2rt.core.rla.rla import (
    ActionReplaced,
    ActionWithdrawn,
    LessonUndone,
    Phase,
    RlaCreated,
    RlaDeleted,
    RlaRewarded,
)
from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.core.teaching.commands import DeleteRla, Reward, Teach, Undo
from tests.core.helpers import MINIMUM_TICKS, RADIUS
from tests.core.reinforcement.helpers import CALM, SHARE, SIGNALS_ONLY, Track, deleted_ids, knows_good_from_bad
from tests.core.rla.helpers import created
from tests.teacher.helpers import correct, teach

LEFT, RIGHT = 0.0, 50.0
KNOWN = (created(1, (LEFT,), "a"), created(2, (RIGHT,), "b"))


def track(*, phase: Phase = Phase.REINFORCEMENT, saved: Statistics | None = None) -> Track:
    return Track(*KNOWN, reinforcement=SIGNALS_ONLY, phase=phase, saved=saved)


def sink(robot: Track, place: float, times: int = 3) -> None:
    """Drive long in one place, and be blamed for it."""
    for _ in range(times):
        robot.go(place, 400)
        robot.signal(-1)


def shares(event: RlaRewarded) -> dict[int, float]:
    """What each RLA was credited with."""
    return {credit.rla_id: credit.change for credit in event.credits}


def test_a_reward_goes_to_those_that_drove_and_its_event_tells_how_much() -> None:
    robot = track()
    robot.go(LEFT, 400)
    robot.go(RIGHT, 20)
    event = robot.signal(1)
    assert (event.rla_id, event.value, event.decided_at_tick) == (2, 1, robot.tick)
    credits_ = shares(event)
    assert credits_.keys() == {1, 2}
    assert sum(credits_.values()) == pytest.approx(0.3, abs=0.002)
    assert (robot.worth(1), robot.worth(2)) == pytest.approx((0.5 + credits_[1], 0.5 + credits_[2]))


def test_a_late_signal_means_the_tick_it_names_and_not_the_one_that_drives_now() -> None:
    robot = track()
    robot.go(LEFT, 400)
    meant = robot.tick
    robot.go(RIGHT, 100)
    event = robot.signal(-1, meant)
    (credit,) = event.credits
    assert credit.rla_id == 1
    assert credit.change == pytest.approx(-0.3, abs=0.002)
    assert robot.worth(2) == 0.5


def test_nobody_is_blamed_while_the_robot_asks_or_stands() -> None:
    robot = track()
    robot.go(LEFT, 100)
    asked = robot.go(25.0)
    assert asked.asking
    refused = robot.say(Reward("r-1", "Ann", -1, robot.tick))
    assert refused.outcome == Outcome(RefusalCode.NO_RLA_DROVE)
    robot.go(LEFT, because=Cause.STOPPED)
    assert not robot.say(Reward("r-2", "Ann", -1, robot.tick)).accepted
    assert (robot.worth(1), robot.worth(2)) == (0.5, 0.5)


def test_an_rla_whose_action_is_held_where_it_is_not_known_is_not_blamed() -> None:
    """The minimum time of an action carries it out of its radius, into that of another."""
    robot = track()
    robot.go(LEFT)
    held = robot.go(RIGHT)
    assert (held.cause, held.rla_id, held.answers) == (Cause.HELD, 1, False)
    refused = robot.say(Reward("r-1", "Ann", -1, robot.tick))
    assert refused.outcome == Outcome.of(RefusalCode.OUTSIDE_RADIUS, rla=1)
    robot.go(RIGHT, MINIMUM_TICKS)
    assert shares(robot.signal(-1)).keys() == {1, 2}  # for the tick in which it was known, and its own


def test_an_rla_whose_action_is_held_inside_its_radius_is_blamed_with_the_others() -> None:
    robot = Track(created(1, (0.0,), "a"), created(2, (4.0,), "b"), reinforcement=SIGNALS_ONLY)
    robot.go(1.0)
    held = robot.go(3.0)
    assert (held.cause, held.rla_id, held.answers) == (Cause.HELD, 1, True)
    assert shares(robot.signal(-1)).keys() == {1}


def test_an_undo_takes_exactly_the_credits_off_whatever_came_after_them() -> None:
    robot = track()
    robot.go(LEFT, 400)
    robot.go(RIGHT, 20)
    blame = robot.signal(-1)
    robot.go(RIGHT, 400)
    robot.signal(1)
    before = (robot.worth(1), robot.worth(2))
    robot.go(LEFT, 400)
    praise = robot.signal(1)
    assert robot.say(Undo("u-1", "Ann", praise.origin.command_id)).accepted
    assert (robot.worth(1), robot.worth(2)) == pytest.approx(before)
    assert robot.say(Undo("u-2", "Ann")).accepted
    assert robot.say(Undo("u-3", "Ann", blame.origin.command_id)).accepted
    assert (robot.worth(1), robot.worth(2)) == pytest.approx((0.5, 0.5))


def test_credits_are_taken_off_the_action_that_they_were_given_to() -> None:
    robot = track()
    robot.go(LEFT, 400)
    robot.go(RIGHT, 20)
    blame = robot.signal(-1)
    assert shares(blame).keys() == {1, 2}
    robot.say(correct("c", "c-1"), LEFT)  # what the first one did was wrong: another action
    assert robot.worth(1) == 0.5
    assert robot.say(Undo("u-1", "Ann", blame.origin.command_id)).accepted
    assert (robot.worth(1), robot.worth(2)) == pytest.approx((0.5, 0.5))
    assert robot.say(Undo("u-2", "Ann", "c-1")).accepted
    assert robot.worth(1) == pytest.approx(0.5)


def test_what_an_rla_did_before_it_was_corrected_is_not_the_new_actions_fault() -> None:
    robot = track()
    robot.go(LEFT, 100)
    wrong = robot.tick
    robot.say(correct("c", "c-1"), LEFT)
    robot.go(LEFT, 10)
    assert robot.signal(-1, wrong).credits == ()
    assert robot.worth(1) == 0.5


def test_an_rla_that_has_sunk_is_withdrawn_stops_the_robot_in_the_next_tick_and_asks() -> None:
    robot = track()
    sink(robot, LEFT)
    assert robot.worth(1) < -0.2
    at_blame = robot.go(LEFT)  # the tick that took the blame had decided already
    (event,) = robot.learnt
    assert isinstance(event, ActionWithdrawn)
    assert (event.rla_id, event.instead_of) == (1, "a")
    assert (event.origin.command_id, event.origin.teacher) == ("signal-3/withdraw-1", "Ann")
    assert at_blame.driving
    after = robot.go(LEFT)
    assert (after.driving, after.asking) == (False, True)
    assert not robot.go(RIGHT).asking


def test_a_value_that_has_sunk_without_blame_changes_nothing() -> None:
    robot = track(saved=Statistics(values={1: -0.9}))
    robot.go(LEFT, 400)
    assert robot.learnt == []
    robot.signal(1)
    robot.go(LEFT)
    assert robot.learnt == []


def test_the_answer_to_a_withdrawn_rla_gives_it_another_action_that_acts_in_the_next_tick() -> None:
    robot = track()
    sink(robot, LEFT)
    robot.go(LEFT, 2)
    robot.go(LEFT + SHARE * RADIUS)
    assert robot.say(Teach("t-1", "Ann", "c", robot.tick)).outcome == Outcome.of(
        ResultCode.RLA_ANSWERED, rla=1, action="c"
    )
    assert robot.actions == {1: "c", 2: "b"}
    assert robot.worth(1) == 0.5
    decision = robot.go(LEFT)
    assert (decision.driving, decision.action) == (True, "c")


def test_an_answer_farther_off_inserts_and_the_withdrawn_one_goes_on_asking() -> None:
    robot = track()
    sink(robot, LEFT)
    robot.go(LEFT, 2)
    assert robot.say(teach("c"), LEFT + SHARE * RADIUS + 0.5).outcome == Outcome.of(
        ResultCode.RLA_TAUGHT, rla=3, action="c"
    )
    assert robot.go(LEFT + SHARE * RADIUS).action == "c"
    assert robot.go(LEFT).asking


def test_a_withdrawal_that_is_undone_lets_the_robot_drive_as_before() -> None:
    robot = track()
    known = robot.hash
    sink(robot, LEFT)
    robot.go(LEFT, 2)
    assert robot.say(Undo("u-1", "Ann")).outcome == Outcome.of(
        ResultCode.LESSON_UNDONE, says="RLA 1 withdrawn: it asks again"
    )
    assert robot.hash == known
    assert robot.go(LEFT).action == "a"


@pytest.mark.parametrize("phase", [Phase.SUPERVISED, Phase.CORRECTIONS, Phase.REINFORCEMENT, Phase.CRITIC])
def test_blame_counts_in_every_phase_that_has_a_teacher(phase: Phase) -> None:
    robot = track(phase=phase)
    sink(robot, LEFT)
    robot.go(LEFT)
    assert [type(event) for event in robot.learnt] == [ActionWithdrawn]
    assert robot.learnt[0].origin.phase is phase


@pytest.mark.parametrize(("phase", "learns"), [(1, False), (2, False), (3, True), (4, True), (5, False)])
def test_values_follow_each_other_only_while_signals_are_to_be_expected(phase: int, learns: bool) -> None:
    robot = Track(*KNOWN, reinforcement=SIGNALS_ONLY.model_copy(update={"step_s": 0.1}), phase=Phase(phase))
    robot.go(LEFT, 400)
    assert (robot.worth(1) < 0.5) == learns


def test_where_nobody_is_asked_a_competitor_takes_the_neighbours_action() -> None:
    robot = track(phase=Phase.AUTONOMOUS)
    sink(robot, LEFT)
    robot.go(LEFT)
    (event,) = robot.learnt
    assert isinstance(event, RlaCreated)
    assert (event.rla.condition, event.rla.action, event.rla.rla_id) == ((LEFT,), "b", 3)
    decision = robot.go(LEFT)
    assert (decision.action, decision.rla_id) == ("b", 3)


def test_a_competitor_that_is_undone_is_gone_and_the_former_one_answers() -> None:
    robot = track(phase=Phase.AUTONOMOUS)
    known = robot.hash
    sink(robot, LEFT)
    robot.go(LEFT, 10)
    assert robot.say(Undo("u-1", "Ann")).accepted
    assert robot.hash == known
    assert robot.go(LEFT).rla_id == 1


def test_one_that_sinks_beside_a_better_one_is_deleted() -> None:
    robot = track(phase=Phase.AUTONOMOUS)
    sink(robot, LEFT)
    robot.go(LEFT, 10)
    robot.reinforcement.choice.reset()
    robot.reinforcement.rule.restore(Statistics(values={1: 0.0, 3: -0.1}))
    sink(robot, LEFT, times=1)  # the first one answers again, and is blamed again
    robot.go(LEFT)
    assert deleted_ids(robot.learnt) == [1]
    assert robot.actions == {2: "b", 3: "b"}


def test_after_enough_tries_all_on_the_condition_are_deleted_so_that_neighbours_answer() -> None:
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


def test_a_correction_on_competitors_means_the_one_that_drove() -> None:
    robot = Track(created(1, (LEFT,), "a"), created(2, (LEFT,), "b"), saved=Statistics(values={1: -0.5}))
    assert robot.go(LEFT).rla_id == 2
    assert robot.say(correct("c"), LEFT).outcome == Outcome.of(ResultCode.RLA_CORRECTED, rla=2, action="c", was="b")
    robot.go(LEFT)
    assert robot.go(LEFT).action == "c"


def test_competitors_that_sink_while_a_teacher_is_there_go_and_the_last_one_asks() -> None:
    saved = Statistics(values={1: 0.0, 2: -0.1})
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


def test_the_same_seed_and_senses_give_the_same_knowledge_and_worths() -> None:
    one, again = whole_story(1), whole_story(1)
    assert len(one.events) > 60
    assert one.events == again.events
    assert one.hash == again.hash
    assert one.reinforcement.rule.values == again.reinforcement.rule.values


def test_everything_that_was_changed_can_be_undone_one_after_the_other() -> None:
    robot = whole_story(1)
    assert any(isinstance(event, RlaDeleted) for event in robot.events)
    first = Track(*(created(n, (4.0 * n,), "abc"[n % 3]) for n in range(1, 12)))
    while len(robot.system.lessons) and robot.system.standing_lessons > 11:
        assert robot.say(Undo(f"undo-{robot.system.standing_lessons}", "Ann")).accepted
    assert robot.hash == first.hash


def test_what_was_taught_in_an_earlier_run_is_known_by_its_credits_where_no_values_were_saved() -> None:
    robot = track()
    robot.go(LEFT, 400)
    robot.go(RIGHT, 20)
    robot.signal(-1)
    robot.go(LEFT, 400)
    robot.signal(1)
    robot.say(correct("c", "c-1"), LEFT)
    robot.signal(1, robot.tick)
    again = Track(*robot.events, reinforcement=SIGNALS_ONLY)
    assert [again.worth(n) for n in (1, 2)] == pytest.approx([robot.worth(n) for n in (1, 2)])
    rewards = [event for event in robot.events if isinstance(event, RlaRewarded)]
    for run in (robot, again):
        assert run.say(Undo("u-1", "Ann", rewards[0].origin.command_id)).accepted
    assert [again.worth(n) for n in (1, 2)] == pytest.approx([robot.worth(n) for n in (1, 2)])
    assert again.learnt == []
    again.go(LEFT)
    assert again.learnt == []  # blame of an earlier run was looked at then


def test_saved_values_go_before_credits_and_an_undo_still_takes_them_off() -> None:
    robot = track()
    robot.go(LEFT, 400)
    blame = robot.signal(-1)
    again = track_with(robot, Statistics(values={1: 0.1}))
    assert again.worth(1) == pytest.approx(0.1)
    assert again.say(Undo("u-1", "Ann", blame.origin.command_id)).accepted
    assert again.worth(1) == pytest.approx(0.1 - blame.credits[0].change)


def test_what_came_after_the_last_checkpoint_is_booked_behind_it_at_the_next_start() -> None:
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
    assert [again.worth(n) for n in (1, 2)] == pytest.approx([robot.worth(n) for n in (1, 2)])
    assert again.reinforcement.snapshot() == robot.reinforcement.snapshot()
    for run in (robot, again):
        for lesson in ("c-1", "signal-3", "signal-2", "signal-1"):
            assert run.say(Undo(f"u-{lesson}", "Ann", lesson)).accepted
    assert [again.worth(n) for n in (1, 2)] == pytest.approx([0.5, 0.5])


def test_an_answer_after_the_last_checkpoint_does_not_begin_with_what_its_forerunner_was_worth() -> None:
    robot = track()
    sink(robot, LEFT)
    robot.go(LEFT, 2)
    saved = robot.reinforcement.snapshot()
    assert robot.say(teach("b", "again"), LEFT).accepted
    again = track_with(robot, saved)
    assert again.worth(1) == robot.worth(1) == 0.5


def test_a_run_with_the_other_rule_leaves_what_was_learnt_as_it_is() -> None:
    robot = track()
    robot.go(LEFT, 400)
    robot.signal(-1)
    robot.go(RIGHT, 400)
    robot.signal(-1)
    saved = robot.reinforcement.snapshot()
    other = Track(*robot.events, reinforcement=ReinforcementSettings(rule="edge_weights"), saved=saved)
    other.go(RIGHT, 20)
    other.go(LEFT, 20)
    other.say(correct("c", "c-1"), RIGHT)
    then = other.reinforcement.snapshot()
    assert then.values == saved.values
    assert then.edge_weights == {(2, 1): 100.0}
    back = Track(*other.events, reinforcement=SIGNALS_ONLY, saved=then)
    assert (back.worth(1), back.worth(2)) == pytest.approx((robot.worth(1), 0.5))  # the second one was corrected
    assert back.reinforcement.snapshot().edge_weights == then.edge_weights


def track_with(robot: Track, saved: Statistics) -> Track:
    return Track(*robot.events, reinforcement=SIGNALS_ONLY, saved=saved)


def test_the_other_rule_withdraws_as_well() -> None:
    settings = ReinforcementSettings(rule="edge_weights")
    robot = Track(*KNOWN, reinforcement=settings)
    robot.go(RIGHT, 20)
    robot.go(LEFT, 20)
    assert shares(robot.signal(1)).keys() == {1}
    robot.go(RIGHT, 20)
    robot.go(LEFT, 20)
    assert shares(robot.signal(-1)).keys() == {1, 2}
    assert robot.worth(1) == pytest.approx(1 - 1 / 0.97)  # blamed as the newest, and as the third one back
    robot.signal(-1)
    assert robot.worth(1) < -0.1
    robot.go(LEFT)
    assert 1 in {event.rla_id for event in robot.learnt if isinstance(event, ActionWithdrawn)}
    assert robot.go(LEFT).asking


STEPS = SIGNALS_ONLY.model_copy(update={"step_s": 0.1})
NEUTRAL = CALM._replace(front_m=0.30, speed_m_s=5.0)


def test_what_an_rla_was_worth_alone_is_not_held_against_it_when_the_teacher_is_back() -> None:
    robot = Track(*KNOWN, *knows_good_from_bad(), reinforcement=STEPS, phase=Phase.AUTONOMOUS)
    while robot.worth(1) > 0.3:  # unpraised, values sink
        robot.go(LEFT, 100, NEUTRAL)
    assert robot.reinforcement.rule.values == {}
    robot.school.phase = Phase.REINFORCEMENT
    robot.go(LEFT)
    assert robot.worth(1) == 0.5
    robot.school.phase = Phase.AUTONOMOUS
    robot.go(LEFT)
    assert robot.worth(1) == 0.5  # and each phase 5 begins anew


def test_a_teachers_reward_in_phase_5_is_booked_in_both_accounts_and_an_undo_takes_it_off_both() -> None:
    robot = track(phase=Phase.AUTONOMOUS)
    robot.go(LEFT, 400)
    blame = robot.signal(-1)
    assert shares(blame)[1] == pytest.approx(-0.3, abs=0.002)
    assert robot.worth(1) == robot.reinforcement.rule.value(1) == pytest.approx(0.2, abs=0.002)
    then = robot.reinforcement.autonomous_values()
    robot.go(LEFT, 400)
    robot.signal(1)
    robot.reinforcement.restore_autonomous(then, {1})
    assert robot.worth(1) == pytest.approx(0.2, abs=0.002)
    assert robot.reinforcement.rule.value(1) == pytest.approx(0.5, abs=0.002)  # the teacher's stays
    assert robot.say(Undo("u-1", "Ann", robot.events[-1].origin.command_id)).accepted
    assert robot.say(Undo("u-2", "Ann", blame.origin.command_id)).accepted
    assert robot.reinforcement.rule.value(1) == pytest.approx(0.5)
    robot.school.phase = Phase.REINFORCEMENT
    robot.go(LEFT)
    assert robot.worth(1) == pytest.approx(0.5)
    assert robot.reinforcement.autonomous_values() == Statistics()


@pytest.mark.parametrize("rule", ["td_lambda", "edge_weights"])
def test_nothing_is_kept_of_what_is_gone_for_good_and_what_comes_back_has_what_it_had_earned(rule: str) -> None:
    robot = Track(*KNOWN, reinforcement=SIGNALS_ONLY.model_copy(update={"rule": rule}))

    def kept() -> set[int]:
        saved = robot.reinforcement.snapshot()
        return {*saved.values, *(rla_id for edge in saved.edge_weights for rla_id in edge)}

    assert robot.say(teach("c", "t-1"), 20.0).accepted
    for place in (LEFT, RIGHT, 20.0):
        robot.go(place, 20)
    robot.signal(-1)
    worth = robot.worth(3)
    assert 3 in kept()
    assert robot.say(DeleteRla("d-1", "Ann", 3)).accepted
    assert 3 not in kept()
    robot.signal(-1, robot.tick - 21)  # the tick before; and one about a tick in which it drove finds nobody
    assert 3 not in kept()
    assert robot.say(Undo("u-1", "Ann", "d-1")).accepted
    assert robot.worth(3) == pytest.approx(worth)
    assert robot.say(Undo("u-2", "Ann", "signal-1")).accepted
    assert robot.say(Undo("u-3", "Ann", "t-1")).accepted
    assert 3 not in kept()
    assert robot.say(Undo("u-4", "Ann", "signal-2")).accepted  # its credits are not put on what is no more
    assert 3 not in kept()


def test_what_was_tried_on_a_condition_is_kept_as_long_as_an_rla_lives_there() -> None:
    robot = whole_story(1)
    repair = robot.reinforcement._repair
    living = {(rla.behaviour, rla.condition) for rla in robot.system.rlas}
    assert deleted_ids(robot.events)
    assert repair._tried.keys() <= living
    assert set(repair._condition_key_of) <= set(robot.actions)


def test_what_an_earlier_kurt2rt_saved_of_the_dead_is_let_go() -> None:
    robot = track(saved=Statistics(values={1: 0.25, 77: -0.5}))
    assert robot.reinforcement.snapshot().values == {1: 0.25}


def test_an_undone_correction_is_heard_as_one() -> None:
    robot = track()
    robot.say(correct("c", "c-1"), LEFT)
    assert isinstance(robot.events[-1], ActionReplaced)
    robot.say(Undo("u-1", "Ann"))
    assert isinstance(robot.events[-1], LessonUndone)
    robot.go(LEFT, 400)
    assert robot.signal(-1).credits[0].rla_id == 1
