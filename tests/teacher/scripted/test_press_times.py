"""Times of presses to the mid level and of rewards."""

import statistics

from kurt2rt.core.task_settings import TeacherSettings
from kurt2rt.core.teacher_settings import PersonSettings, load_teacher
from kurt2rt.teacher.scripted.human_limits import PressLimit
from kurt2rt.teacher.scripted.press_times import FixedTimes, HumanTimes

LINK_TICKS = 10


def ordinary() -> PersonSettings:
    person = load_teacher("ordinary").person
    assert person is not None
    return person


def human(seed: int = 1, presses_per_minute: int = 0) -> HumanTimes:
    presses = PressLimit(presses_per_minute, 0.01)
    return HumanTimes(ordinary(), presses, period_s=0.01, seed=seed, session="s")


def test_fixed_times_are_those_of_the_task() -> None:
    times = FixedTimes(TeacherSettings(reaction_s=1.0, patience_s=0.2, error_rate=0.1), 0.01)
    assert (times.question_ticks(), times.mistake_ticks(), times.reward_ticks()) == (100, 20, 100)
    assert (times.answer_errors, times.correction_errors) == (0.1, 0.1)
    assert all(times.allows_press() for _ in range(100))


def test_human_times_include_the_link_and_the_time_to_notice() -> None:
    times = human()
    medians = [
        statistics.median(draw() for _ in range(1000))
        for draw in (times.question_ticks, times.mistake_ticks, times.reward_ticks)
    ]
    assert 125 + LINK_TICKS - 8 < medians[0] < 125 + LINK_TICKS + 8
    assert medians[1] - medians[2] > 30


def test_allows_press_limit_is_shared_with_other_presses() -> None:
    presses = PressLimit(2, 0.01)
    times = HumanTimes(ordinary(), presses, period_s=0.01, seed=1, session="s")
    presses.count()
    assert times.allows_press()
    assert not times.allows_press()
    presses.now = 6000
    assert times.allows_press()
