"""Self-teaching in phase 5."""

import pytest

from kurt2rt.core.decision.decision import DecisionCause
from kurt2rt.core.rla.events import LessonUndone, RlaCreated, RlaDeleted, RlaRewarded, TeachingEvent
from kurt2rt.core.rla.rla import CRITIC, MID, Origin, Phase
from kurt2rt.core.teaching.commands import Undo
from tests.core.helpers import sensed, situation
from tests.core.reinforcement.helpers import (
    CALM,
    CRASHED,
    SIGNALS_ONLY,
    Track,
    deleted_ids,
    knows_good_from_bad,
)
from tests.core.rla.helpers import created
from tests.teacher.helpers import teach

HERE, THERE = 0.0, 50.0
KNOWN = (created(1, (HERE,), "a"), created(2, (THERE,), "b"))


def alone(phase: Phase = Phase.AUTONOMOUS) -> Track:
    """Return a robot with few RLAs and a trusted critic."""
    robot = Track(*KNOWN, *knows_good_from_bad(), reinforcement=SIGNALS_ONLY, phase=phase)
    assert robot.agreement.trusted
    return robot


def at_work() -> Track:
    """Return the robot after its first window, which only measures."""
    robot = alone()
    robot.go(THERE, 50, CALM)
    robot.go(HERE, 50, CALM)
    return robot


def lose_trust(robot: Track) -> None:
    """Let a teacher contradict the critic."""
    for number in range(5):
        told = Origin(f"doubt-{number}", "Ann", Phase.AUTONOMOUS, robot.tick)
        event = RlaRewarded(2, 1, robot.tick, told, (), said=-1)
        robot.school.updater.apply(event)
        robot.events.append(event)
    assert not robot.agreement.trusted


def changes(robot: Track) -> list[TeachingEvent]:
    return [event for event in robot.events if event.origin.teacher == CRITIC]


def test_critic_bad_opinion_repairs_without_teacher() -> None:
    robot = alone()
    while not changes(robot):
        robot.go(HERE, 1, CRASHED)
    (event,) = changes(robot)
    assert isinstance(event, RlaCreated)
    assert (event.rla.condition, event.rla.action) == ((HERE,), "b")
    assert (event.origin.teacher, event.origin.phase) == (CRITIC, Phase.AUTONOMOUS)
    assert robot.go(HERE).action == "b"


@pytest.mark.parametrize("phase", [Phase.SUPERVISED, Phase.CRITIC])
def test_critic_with_teacher_only_listens(phase: Phase) -> None:
    robot = alone(phase)
    robot.go(HERE, 300, CRASHED)
    assert changes(robot) == []
    assert robot.value(1) == 0.5


def test_critic_untrusted_changes_nothing() -> None:
    robot = Track(*KNOWN, *knows_good_from_bad()[:2], phase=Phase.AUTONOMOUS)
    assert not robot.agreement.trusted
    known = robot.hash
    robot.go(HERE, 300, CRASHED)
    robot.go(THERE, 300, CALM)
    assert (robot.hash, robot.learnt, changes(robot)) == (known, [], [])
    assert (robot.value(1), robot.value(2)) == (0.5, 0.5)


def test_critic_lost_trust_returns_to_listening() -> None:
    robot = at_work()
    robot.go(HERE, 10, CRASHED)
    assert robot.value(1) < 0.5
    lose_trust(robot)
    known, worth = robot.hash, robot.value(1)
    robot.go(HERE, 300, CRASHED)
    assert (robot.hash, robot.value(1), changes(robot)) == (known, worth, [])


def crowded() -> Track:
    """Many RLAs close together, and nothing that they do is right."""
    known = (created(n, (3.0 * n,), "abc"[n % 3]) for n in range(1, 12))
    robot = Track(*known, *knows_good_from_bad(), reinforcement=SIGNALS_ONLY, phase=Phase.AUTONOMOUS)
    for turn in range(40):
        robot.go(3.0 * (turn * 7 % 12), 80, CRASHED)
    return robot


def test_critic_changes_have_unique_ids_and_undo() -> None:
    robot = crowded()
    known = Track(*robot.events[: 11 + len(knows_good_from_bad())]).hash
    made = changes(robot)
    assert {type(event) for event in made} == {RlaCreated, RlaDeleted}
    assert len(made) > 20
    assert len({event.origin.command_id for event in robot.events}) == len(robot.events)
    while any(record.event.origin.teacher == CRITIC and not record.undone for record in robot.system.lessons):
        assert robot.say(Undo(f"undo-{len(robot.events)}", "Ann")).accepted
    assert robot.hash == known


def test_critic_changes_are_equal_after_reload() -> None:
    robot = crowded()
    again = Track(*robot.events, reinforcement=SIGNALS_ONLY, phase=Phase.AUTONOMOUS)
    assert again.hash == robot.hash
    for place, action in ((80.0, "a"), (85.0, "b")):
        again.say(teach(action, f"t-{action}"), place)
    again.go(80.0, 200, CRASHED)  # and what comes then has new ids, which the system would refuse otherwise
    assert len({event.origin.command_id for event in again.events}) == len(again.events)
    assert len(changes(again)) > len(changes(robot))


class Judged:
    """A robot that does well for a while, and then badly."""

    def __init__(self) -> None:
        self.robot = alone()
        self.robot.go(THERE, 100, CALM)  # a good window
        self.known = self.robot.hash

    def bad_window(self) -> None:
        self.robot.go(HERE, 100, CRASHED)


def test_rollback_restores_values_of_best_window() -> None:
    story = Judged()
    robot, worth = story.robot, story.robot.value(2)
    while not changes(robot):
        robot.go(HERE, 1, CRASHED)
    (event,) = changes(robot)
    assert isinstance(event, RlaCreated)
    assert event.rla.condition == (THERE,)  # RLA 2 had sunk
    assert robot.value(2) < worth
    while not robot.self_teaching.is_measuring:  # a roll-back ends the window
        robot.go(HERE, 1, CRASHED)
    assert robot.value(2) == worth


def test_rollback_keeps_other_values_and_rewards() -> None:
    story = Judged()
    robot = story.robot
    robot.go(THERE, 10, CALM)
    robot.signal(1)
    of_teacher = dict(robot.reinforcement.rule.values)
    assert of_teacher
    while not any(isinstance(event, LessonUndone) for event in changes(robot)):
        worths = [robot.value(rla_id) for rla_id in (1, 2)]
        robot.go(HERE, 1, CRASHED)
    assert {event.rla.condition for event in changes(robot) if isinstance(event, RlaCreated)} == {(HERE,)}
    assert robot.hash == story.known
    assert dict(robot.reinforcement.rule.values) == of_teacher
    assert deleted_ids(changes(robot)) == [1]  # it had sunk
    assert worths[1] != 0.5
    assert [robot.value(rla_id) for rla_id in (1, 2)] == [0.5, worths[1]]  # nothing was changed at RLA 2's condition


def test_window_after_rollback_only_measures() -> None:
    story = Judged()
    story.bad_window()
    robot, known, told = story.robot, story.robot.hash, len(changes(story.robot))
    assert isinstance(changes(robot)[-1], LessonUndone)
    robot.go(HERE, 100, CRASHED)
    assert (robot.hash, len(changes(robot))) == (known, told)
    robot.go(HERE, 400, CRASHED)
    assert len(changes(robot)) > told


def test_manual_driving_does_not_count() -> None:
    robot = alone()
    for _ in range(300):
        robot.tick += 1
        stands = robot.level.decide(situation(HERE), sensed(), DecisionCause.TEACHER)
        by_hand = stands._replace(action="b")
        robot.school.learn(robot.tick, by_hand, robot.critic.appraise(robot.tick, CRASHED))
    robot.go(HERE, 100, CRASHED)  # its first window, in which it only looks
    assert robot.value(1) == 0.5
    robot.go(HERE, 1, CRASHED)
    assert robot.value(1) < 0.5


def test_return_to_phase_5_measures_first() -> None:
    robot = at_work()
    robot.school.phase = Phase.SUPERVISED
    robot.go(HERE, 10, CRASHED)
    robot.school.phase = Phase.AUTONOMOUS
    robot.go(HERE, 100, CRASHED)
    assert changes(robot) == []
    robot.go(HERE, 100, CRASHED)
    assert changes(robot) != []


def started_again(robot: Track) -> Track:
    saved = robot.self_teaching.with_best(robot.reinforcement.snapshot())
    return Track(*robot.events, reinforcement=SIGNALS_ONLY, phase=Phase.AUTONOMOUS, saved=saved)


def test_restart_keeps_unproven_lessons_unproven() -> None:
    story = Judged()
    story.robot.go(HERE, 90, CRASHED)
    assert story.robot.hash != story.known
    robot = started_again(story.robot)
    assert robot.hash == story.robot.hash
    robot.go(HERE, 99, CRASHED)
    assert robot.hash == story.robot.hash  # it only looks
    robot.go(HERE, 1, CRASHED)
    assert robot.hash == story.known
    again = started_again(robot)  # and what is come back to is measured as it is
    again.go(HERE, 100, CRASHED)
    assert again.hash == story.known


def test_restart_keeps_proven_lessons() -> None:
    robot = alone()
    robot.go(HERE, 100, CRASHED)  # what it is measured against
    while not changes(robot):
        robot.go(HERE, 1, CRASHED)
    made = robot.hash
    robot.go(THERE, 200, CALM)  # two good windows: in the first one it was changed
    again = started_again(robot)
    again.go(HERE, 100, CRASHED)
    assert again.hash == robot.hash == made


def test_rolled_back_try_is_not_repeated() -> None:
    known = (created(1, (HERE,), "a"), created(2, (THERE,), "b"), created(3, (-THERE,), "c"))
    robot = Track(*known, *knows_good_from_bad(), reinforcement=SIGNALS_ONLY, phase=Phase.AUTONOMOUS)
    for _ in range(10):
        robot.go(THERE, 100, CALM)
        robot.go(HERE, 100, CRASHED)
    rolled_back = [event.lesson for event in robot.events if isinstance(event, LessonUndone)]
    tries = [(event.rla.condition, event.rla.action) for event in changes(robot) if isinstance(event, RlaCreated)]
    assert rolled_back
    assert len(tries) == len(set(tries)), tries


def test_mid_level_question_does_not_lower_the_score() -> None:
    robot = Judged().robot
    while not changes(robot):
        robot.go(HERE, 1, CRASHED)
    known = robot.hash
    for _ in range(300):
        robot.tick += 1
        stands = robot.level.decide(situation(HERE), sensed(), DecisionCause.UNKNOWN)._replace(asks_at=MID)
        assert robot.school.learn(robot.tick, stands, robot.critic.appraise(robot.tick, CALM)) == []
    assert robot.hash == known
