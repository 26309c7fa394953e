"""Delay of teachers, learned from their answers to questions."""

import pytest

from kurt2rt.core.teaching.late_press import DEFAULT_TICKS, TeacherDelay


def asked_and_answered(delay: TeacherDelay, *took: int, teacher: str = "Ann", speed: int = 1) -> None:
    """Ask a question for each time in ticks, and answer it after so long."""
    for number, ticks in enumerate(took):
        tick = 10_000 * (number + 1)
        delay.on_decision(tick, asks=True)
        delay.on_answer(teacher, tick + ticks, speed)
        delay.on_decision(tick + ticks + 1, asks=False)


def answers_of_ann(delay: TeacherDelay) -> int:
    return len(delay.snapshot().get("Ann", ()))


@pytest.mark.parametrize(("took", "ticks"), [((30, 30, 30, 90), 30), ((30, 90, 30, 90), 90), ((3, 6, 9, 1, 2), 3)])
def test_delay_is_median_of_the_answers(took: tuple[int, ...], ticks: int) -> None:
    delay = TeacherDelay()
    asked_and_answered(delay, *took)
    assert delay.ticks("Ann", 1) == ticks
    assert delay.ticks("Ben", 1) == DEFAULT_TICKS


def test_impossible_times_of_a_file_are_left_out() -> None:
    delay = TeacherDelay(saved={"Ann": (-1, 30, 2**62, 30, 30, 30)})
    assert (delay.ticks("Ann", 1), delay.answers("Ann")) == (30, 4)


def test_answer_after_five_seconds_is_no_delay() -> None:
    delay = TeacherDelay()
    asked_and_answered(delay, 500, 501, 5000)
    assert answers_of_ann(delay) == 1
