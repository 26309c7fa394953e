"""Workload of a teacher, minute by minute."""

from kurt2rt.core.rla.rla import Phase
from kurt2rt.core.teaching.commands import (
    Appraise,
    Correct,
    DeleteRla,
    HoldAction,
    Pursue,
    Resume,
    Reward,
    SetPhase,
    Stop,
    Teach,
    Undo,
)
from kurt2rt.experiments.lockstep.teacher_workload import TeacherWorkload, WorkloadMinute


def test_each_kind_is_counted_in_its_minute() -> None:
    load = TeacherWorkload(ticks=15_000, period_s=0.01)
    load.count(1, Teach("1", "Ann", "a"))
    load.count(6_000, Correct("2", "Ann", "a"))
    load.count(6_001, DeleteRla("3", "Ann", 1))
    load.count(12_001, Reward("4", "Ann", 1))
    load.count(15_000, Appraise("5", "Ann", "good"))
    assert load.minutes == (
        WorkloadMinute(lessons=1, corrections=1),
        WorkloadMinute(corrections=1),
        WorkloadMinute(rewards=1, appraisals=1),
    )


def test_the_work_of_the_hands_is_load_too() -> None:
    load = TeacherWorkload(ticks=12_000, period_s=0.01)
    load.count_manual(1, "set_down")
    load.count_manual(6_000, "set_down")
    load.count_manual(6_001, "shown")
    load.count_manual(6_001, "rescued")
    load.count_manual(12_000, "go")
    assert load.minutes == (WorkloadMinute(set_down=2), WorkloadMinute(shown=1, rescued=1, go=1))


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


def test_workload_leaves_out_other_commands() -> None:
    load = TeacherWorkload(ticks=100, period_s=0.01)
    load.count(1, SetPhase("1", "Ann", Phase.CRITIC))
    load.count(2, Pursue("2", "Ann", ""))
    assert load.minutes == (WorkloadMinute(),)
