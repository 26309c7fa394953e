"""Decisions before a standstill, for a teacher who looks back."""

from dataclasses import replace

import numpy as np

from hal.robot import STANDSTILL
from kurt2rt.core.decision.decision import Decision, DecisionCause
from kurt2rt.core.outcome import Outcome, ResultCode
from kurt2rt.core.perception.perception import Situation
from kurt2rt.core.reinforcement.decision_history import DecisionHistory
from kurt2rt.core.teaching.late_press import RewindHistory
from tests.core.rla.helpers import created
from tests.core.teaching.test_command_handler import Lesson
from tests.teacher.helpers import correct

CAPACITY = 1000


class Drive:
    """Robot that drives or stands."""

    def __init__(self) -> None:
        self.recent = DecisionHistory(1, CAPACITY)
        self.rewind = RewindHistory(self.recent)
        self.tick = 0

    def run(self, ticks: int, *, driving: bool) -> int:
        """Run so many ticks; return the first of them."""
        first = self.tick
        for _ in range(ticks):
            situation = Situation(np.array([float(self.tick)]), history_frozen=False)
            self.recent.add(self.tick, situation, Decision(STANDSTILL, DecisionCause.RLA, "a", 1, None, True))
            self.rewind.update(driving=driving)
            self.tick += 1
        return first

    def remembers(self, tick: int) -> bool:
        found = self.rewind.find(tick)
        return found is not None and found[0].situation(found[1]).tolist() == [tick]


def test_rewind_finds_the_drive_before_pulses_and_questions() -> None:
    drive = Drive()
    drive.run(1000, driving=True)
    pulses = []
    for _ in range(50):  # a question at the border of R: the wheels turn for two ticks a second
        drive.run(98, driving=False)
        pulses.append(drive.run(2, driving=True))
    drive.run(1500, driving=False)
    assert all(map(drive.remembers, [*range(1000), *pulses]))
    assert not drive.remembers(1050)


def test_correction_after_long_standstill_is_about_the_drive() -> None:
    lesson = Lesson(created(1, (0.0,), "a"))
    wrong = lesson.go_on(40.0)
    lesson.school.before_decision(lesson.tick, was_driving=True, turned=True)
    lesson.school.before_decision(lesson.go_on(0.0), was_driving=False, turned=False)
    lesson.go_on(0.0, 3000)
    result = lesson.say(replace(correct("b"), decision_tick=wrong))
    assert result.outcome == Outcome.of(ResultCode.RLA_TAUGHT, rla=2, action="b")
    assert lesson.small.level.system.rlas[-1].condition == (40.0,)
