"""Self-teaching in phase 5."""

from kurt2rt.core.rla.events import LessonUndone, RlaCreated, TeachingEvent
from kurt2rt.core.rla.rla import CRITIC, Phase
from tests.core.reinforcement.helpers import CALM, CRASHED, SIGNALS_ONLY, Track, knows_good_from_bad
from tests.core.rla.helpers import created
from tests.teacher.helpers import teach

HERE, THERE = 0.0, 50.0
KNOWN = (created(1, (HERE,), "a"), created(2, (THERE,), "b"))


def alone(phase: Phase = Phase.AUTONOMOUS) -> Track:
    """Return a robot with few RLAs and a trusted critic."""
    robot = Track(*KNOWN, *knows_good_from_bad(), reinforcement=SIGNALS_ONLY, phase=phase)
    assert robot.agreement.trusted
    return robot


def changes(robot: Track) -> list[TeachingEvent]:
    return [event for event in robot.events if event.origin.teacher == CRITIC]


def test_critic_untrusted_changes_nothing() -> None:
    robot = Track(*KNOWN, *knows_good_from_bad()[:2], phase=Phase.AUTONOMOUS)
    assert not robot.agreement.trusted
    known = robot.hash
    robot.go(HERE, 300, CRASHED)
    robot.go(THERE, 300, CALM)
    assert (robot.hash, robot.learnt, changes(robot)) == (known, [], [])
    assert (robot.value(1), robot.value(2)) == (0.5, 0.5)


def crowded() -> Track:
    """Many RLAs close together, and nothing that they do is right."""
    known = (created(n, (3.0 * n,), "abc"[n % 3]) for n in range(1, 12))
    robot = Track(*known, *knows_good_from_bad(), reinforcement=SIGNALS_ONLY, phase=Phase.AUTONOMOUS)
    for turn in range(40):
        robot.go(3.0 * (turn * 7 % 12), 80, CRASHED)
    return robot


def test_critic_changes_are_equal_after_reload() -> None:
    robot = crowded()
    again = Track(*robot.events, reinforcement=SIGNALS_ONLY, phase=Phase.AUTONOMOUS)
    assert again.hash == robot.hash
    for place, action in ((80.0, "a"), (85.0, "b")):
        again.say(teach(action, f"t-{action}"), place)
    again.go(80.0, 200, CRASHED)  # and what comes then has new ids, which the system would refuse otherwise
    assert len({event.origin.command_id for event in again.events}) == len(again.events)
    assert len(changes(again)) > len(changes(robot))


def started_again(robot: Track) -> Track:
    saved = robot.self_teaching.with_best(robot.reinforcement.snapshot())
    return Track(*robot.events, reinforcement=SIGNALS_ONLY, phase=Phase.AUTONOMOUS, saved=saved)


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
