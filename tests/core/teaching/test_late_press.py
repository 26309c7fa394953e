"""Late presses: corrections that are given to the decision that their teacher reacted to."""

import pytest

from kurt2rt.core.outcome import RefusalCode, ResultCode
from kurt2rt.core.teaching.commands import CommandResult, Correct
from kurt2rt.core.teaching.inbox import RobotRepositioned
from kurt2rt.core.teaching.late_press import CORRECTION_PART, DEFAULT_TICKS
from tests.core.test_tick import Corridor
from tests.core.test_tick_holding import condition
from tests.teacher.helpers import resume, stop, teach

DELAY = round(DEFAULT_TICKS * CORRECTION_PART)


@pytest.fixture
def driving() -> Corridor:
    """Return a robot that drove forward for a second at 100 counts, for 0.5 s at 130 and 0.5 s at 132."""
    corridor = Corridor()
    corridor.run(100, teach("forward", "first"))
    for counts, ticks in ((100, 100), (130, DELAY - DELAY // 2 + 1), (132, DELAY // 2)):
        for _ in range(ticks):
            assert corridor.run(counts).decision.action == "forward"
    return corridor


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
    for _ in range(1300):
        driving.run(100)
    assert given(driving, press(driving, age=1400)).code is RefusalCode.TICK_FORGOTTEN


def test_blind_robot_takes_a_late_press(driving: Corridor) -> None:
    driving.robot.infrared_age_s = 1.0
    assert given(driving, press(driving)).accepted
