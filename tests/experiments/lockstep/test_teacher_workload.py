"""Workload of a teacher, minute by minute."""

from kurt2rt.core.teaching.commands import Correct, HoldAction, Resume, Stop, Undo
from kurt2rt.experiments.lockstep.teacher_workload import TeacherWorkload, WorkloadMinute


def test_presses_are_all_that_a_correction_took() -> None:
    load = TeacherWorkload(ticks=6_000, period_s=0.01)
    load.count(1, Stop("1", "Ann"))
    load.count(2, Correct("2", "Ann", "a", decision_tick=1))
    load.count(2, Resume("3", "Ann"))
    load.count(3, Undo("4", "Ann", "2"))
    (minute,) = load.minutes
    assert minute == WorkloadMinute(corrections=1, stops=1, undone=1)
    assert minute.presses == 3
    assert load.press_ticks == [1, 2, 3]


def test_the_release_of_a_hold_is_no_press() -> None:
    load = TeacherWorkload(ticks=6_000, period_s=0.01)
    load.count(1, HoldAction("Ann", 1, 7, "a"))
    load.count(2, Stop("1", "Ann", press_id=7))
    assert load.minutes[0].presses == 1
    assert load.press_ticks == [1]
