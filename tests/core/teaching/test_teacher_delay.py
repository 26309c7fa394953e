"""Delay of teachers, learned from their answers to questions."""

import pytest

from kurt2rt.core.teaching.late_press import BACK_TICKS, DEFAULT_TICKS, TeacherDelay


def asked_and_answered(delay: TeacherDelay, *took: int, teacher: str = "Ann", speed: int = 1) -> None:
    """Ask a question for each time in ticks, and answer it after so long."""
    for number, ticks in enumerate(took):
        tick = 10_000 * (number + 1)
        delay.on_decision(tick, asks=True)
        delay.on_answer(teacher, tick + ticks, speed)
        delay.on_decision(tick + ticks + 1, asks=False)


def answers_of_ann(delay: TeacherDelay) -> int:
    return len(delay.snapshot().get("Ann", ()))


def test_delay_is_default_before_four_answers() -> None:
    delay = TeacherDelay()
    asked_and_answered(delay, 30, 30, 30)
    assert (delay.ticks("Ann", 1), delay.answers("Ann")) == (DEFAULT_TICKS, 0)


@pytest.mark.parametrize(("took", "ticks"), [((30, 30, 30, 90), 30), ((30, 90, 30, 90), 90), ((3, 6, 9, 1, 2), 3)])
def test_delay_is_median_of_the_answers(took: tuple[int, ...], ticks: int) -> None:
    delay = TeacherDelay()
    asked_and_answered(delay, *took)
    assert delay.ticks("Ann", 1) == ticks
    assert delay.ticks("Ben", 1) == DEFAULT_TICKS


def test_delay_follows_the_last_sixteen_answers() -> None:
    delay = TeacherDelay()
    asked_and_answered(delay, *[150] * 20, *[40] * 16)
    assert (delay.ticks("Ann", 1), delay.answers("Ann")) == (40, 16)


def test_delay_goes_on_from_the_answers_of_earlier_runs() -> None:
    before = TeacherDelay()
    asked_and_answered(before, *range(20))
    after = TeacherDelay(saved=before.snapshot())
    assert before.snapshot() == {"Ann": tuple(range(4, 20))}
    asked_and_answered(after, 500, 500)
    asked_and_answered(before, 500, 500)
    assert (after.ticks("Ann", 1), after.snapshot()) == (before.ticks("Ann", 1), before.snapshot())


def test_impossible_times_of_a_file_are_left_out() -> None:
    delay = TeacherDelay(saved={"Ann": (-1, 30, 2**62, 30, 30, 30)})
    assert (delay.ticks("Ann", 1), delay.answers("Ann")) == (30, 4)


def test_delay_is_at_most_two_seconds() -> None:
    delay = TeacherDelay()
    asked_and_answered(delay, *[400] * 4)
    assert delay.ticks("Ann", 1) == BACK_TICKS


def test_answer_after_five_seconds_is_no_delay() -> None:
    delay = TeacherDelay()
    asked_and_answered(delay, 500, 501, 5000)
    assert answers_of_ann(delay) == 1


def test_answer_of_a_teacher_who_came_later_is_no_delay() -> None:
    delay = TeacherDelay()
    delay.on_decision(100, asks=True, present=False)
    delay.on_decision(300, asks=True)
    delay.on_answer("Ann", 350, 1)
    assert (delay.asked_tick, answers_of_ann(delay)) == (100, 0)


def test_press_before_the_question_is_no_answer() -> None:
    delay = TeacherDelay()
    delay.on_answer("Ann", 90, 1)
    delay.on_decision(100, asks=True)
    delay.on_answer("Ann", 99, 1)
    assert answers_of_ann(delay) == 0
    delay.on_answer("Ann", 100, 1)
    assert answers_of_ann(delay) == 1


def test_delay_is_counted_in_real_time_at_any_speed() -> None:
    delay = TeacherDelay()
    asked_and_answered(delay, *[240] * 4, speed=4)
    assert (delay.ticks("Ann", 1), delay.ticks("Ann", 4)) == (60, 240)


@pytest.mark.parametrize(("took", "hand"), [(125, 31), (75, 18), (400, 50)])
def test_hand_is_four_times_as_fast_as_an_answer(took: int, hand: int) -> None:
    delay = TeacherDelay()
    for asked in range(0, 4000, 1000):
        delay.on_decision(asked, asks=True)
        delay.on_answer("Ann", asked + took, 1)
        delay.on_decision(asked + took, asks=False)
    assert delay.hand_ticks("Ann", 1) == hand
