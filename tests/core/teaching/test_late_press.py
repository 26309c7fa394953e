"""Presses about an earlier moment: the delay of teachers, late presses, and rewinds."""

from dataclasses import replace

import numpy as np
import pytest

from hal.robot import STANDSTILL
from kurt2rt.core.decision.decision import Decision, DecisionCause
from kurt2rt.core.outcome import Outcome, RefusalCode, ResultCode
from kurt2rt.core.perception.perception import Situation
from kurt2rt.core.reinforcement.decision_history import DecisionHistory
from kurt2rt.core.teaching.commands import CommandResult, Correct
from kurt2rt.core.teaching.inbox import RobotRepositioned
from kurt2rt.core.teaching.late_press import CORRECTION_PART, DEFAULT_TICKS, RewindHistory, TeacherDelay
from tests.core.rla.helpers import created
from tests.core.teaching.test_command_handler import Lesson
from tests.core.test_tick import Corridor
from tests.core.test_tick_holding import condition
from tests.teacher.helpers import correct, resume, stop


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


DELAY = round(DEFAULT_TICKS * CORRECTION_PART)


@pytest.fixture
def driving(driving: Corridor) -> Corridor:
    """Return a robot that drove forward for two seconds at 100 counts, for 0.5 s at 130 and 0.5 s at 132."""
    for counts, ticks in ((130, DELAY - DELAY // 2 + 1), (132, DELAY // 2)):
        for _ in range(ticks):
            assert driving.run(counts).decision.action == "forward"
    return driving


def press(corridor: Corridor, action: str = "back", *, name: str = "late", age: int = 0) -> Correct:
    return Correct(name, "Ann", action, late=True, seen_tick=corridor.ticks - age)


def given(corridor: Corridor, command: Correct, counts: int | None = None) -> CommandResult:
    (result,) = corridor.run(counts, command).results
    return result


def test_late_press_corrects_the_decision_one_delay_before(driving: Corridor) -> None:
    meant = driving.ticks - DELAY
    result = given(driving, press(driving))
    assert result.code is ResultCode.RLA_TAUGHT
    fields = result.outcome.fields
    assert (fields["decision_tick"], fields["put_back_ticks"], fields["decided_by"]) == (meant, DELAY, 1)
    assert driving.system.rlas[-1].condition == condition(driving, meant)


def test_late_press_of_a_known_mistake_teaches_nothing_more(driving: Corridor) -> None:
    given(driving, press(driving))
    driving.run(130)
    assert given(driving, press(driving, name="again", age=2)).code is ResultCode.RLA_AGREES
    assert len(driving.system.rlas) == 2


def test_late_press_names_no_decision_before_the_robot_drove(driving: Corridor) -> None:
    driving.run(100, stop())
    for _ in range(DELAY):
        driving.run(130)
    first = driving.run(130, resume()).tick
    for _ in range(29):
        driving.run(130)
    assert given(driving, press(driving)).outcome.fields["decision_tick"] == first


def asks_and_goes_on(corridor: Corridor, ticks: int) -> int:
    """Let the robot ask for 5 ticks and drive on by itself for `ticks`; return the last tick of its question."""
    for _ in range(5):
        asked = corridor.run(400)
    assert asked.decision.asking
    for _ in range(ticks):
        assert corridor.run(100).decision.action == "forward"
    return asked.tick


def test_late_press_answers_no_question_of_another_place(driving: Corridor) -> None:
    asked = asks_and_goes_on(driving, 1)
    driving.inbox.put(RobotRepositioned())
    for _ in range(DELAY - 10):
        driving.run(100)
    assert given(driving, press(driving)).outcome.fields["decision_tick"] != asked


def test_late_press_answers_a_question_once(driving: Corridor) -> None:
    asked = asks_and_goes_on(driving, DELAY // 2)
    assert given(driving, press(driving)).outcome.fields["decision_tick"] == asked
    again = given(driving, press(driving, name="again"))
    assert again.outcome.fields["decision_tick"] != asked


def test_late_press_about_forgotten_state_is_refused(driving: Corridor) -> None:
    for _ in range(6300):
        driving.run(100)
    assert given(driving, press(driving, age=6400)).code is RefusalCode.TICK_FORGOTTEN


def test_blind_robot_takes_a_late_press(driving: Corridor) -> None:
    driving.robot.infrared_age_s = 1.0
    assert given(driving, press(driving)).accepted


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
