"""Decisions before a standstill, for a teacher who looks back."""

from dataclasses import replace

import numpy as np
import pytest

from hal.robot import STANDSTILL
from kurt2rt.core.decision.decision import Decision, DecisionCause
from kurt2rt.core.outcome import Outcome, RefusalCode, ResultCode
from kurt2rt.core.perception.perception import Situation
from kurt2rt.core.reinforcement.decision_history import DecisionHistory
from kurt2rt.core.teaching.rewind_history import RewindHistory
from tests.core.rla.helpers import created
from tests.core.teaching.test_command_handler import Lesson
from tests.teacher.helpers import correct

CAPACITY = 10


class Drive:
    """Robot that drives or stands, with a short history."""

    def __init__(self) -> None:
        self.recent = DecisionHistory(1, CAPACITY)
        self.rewind = RewindHistory(self.recent)
        self.tick = 0

    def run(self, ticks: int, *, driving: bool) -> None:
        for _ in range(ticks):
            situation = Situation(np.array([float(self.tick)]), history_frozen=False)
            self.recent.add(self.tick, situation, Decision(STANDSTILL, DecisionCause.RLA, "a", 1, None, True))
            self.rewind.update(driving=driving)
            self.tick += 1


def test_rewind_standing_for_long_finds_the_drive_before() -> None:
    drive = Drive()
    drive.run(30, driving=True)
    drive.run(500, driving=False)
    history = drive.rewind.find(25)
    assert history is not None
    assert history.situation(25).tolist() == [25.0]
    assert drive.rewind.find(30 - CAPACITY) is None


def test_rewind_after_the_next_drive_forgets_the_one_before() -> None:
    drive = Drive()
    drive.run(30, driving=True)
    drive.run(50, driving=False)
    drive.run(30, driving=True)
    drive.run(50, driving=False)
    assert drive.rewind.find(25) is None
    assert drive.rewind.find(105) is not None


@pytest.mark.parametrize("tick", [-1, 10_000])
def test_rewind_unknown_tick_is_not_found(tick: int) -> None:
    assert Drive().rewind.find(tick) is None


def test_correction_after_long_standstill_is_about_the_drive() -> None:
    lesson = Lesson(created(1, (0.0,), "a"))
    wrong = lesson.go_on(40.0)
    lesson.school.before_decision(lesson.tick, was_driving=True)
    lesson.school.before_decision(lesson.go_on(0.0), was_driving=False)
    lesson.go_on(0.0, 3000)
    result = lesson.say(replace(correct("b"), decision_tick=wrong))
    assert result.outcome == Outcome.of(ResultCode.RLA_TAUGHT, rla=2, action="b")
    assert lesson.small.level.system.rlas[-1].condition == (40.0,)


def test_correction_of_a_tick_before_the_kept_ones_is_refused() -> None:
    lesson = Lesson(created(1, (0.0,), "a"))
    old = lesson.go_on(40.0)
    lesson.go_on(0.0, 3000)
    lesson.school.before_decision(lesson.tick, was_driving=True)
    lesson.school.before_decision(lesson.go_on(0.0), was_driving=False)
    assert lesson.say(replace(correct("b"), decision_tick=old)).outcome == Outcome.of(
        RefusalCode.TICK_FORGOTTEN, tick=old
    )
