"""A resume says what still holds the robot."""

import pytest

from hal.guard_reason import GuardReason
from kurt2rt.core.decision.decision import StandReason
from kurt2rt.core.outcome import Outcome, ResultCode
from kurt2rt.core.outcome_text import text_of
from tests.core.test_tick import Corridor
from tests.teacher.helpers import resume, stop


@pytest.mark.parametrize(
    ("reason", "stands"),
    [(GuardReason.BUS_LOST, StandReason.BUS_LOST), (GuardReason.PROGRAM_WAITS, StandReason.HALTED)],
)
def test_tick_resume_tells_the_stop_that_lasts(driving: Corridor, reason: GuardReason, stands: StandReason) -> None:
    driving.robot.latches_for = reason
    driving.robot.emergency_stop(reason)
    driving.run()
    driving.robot.relatches = True
    (result,) = driving.run(100, resume("too early")).results
    assert result.outcome.fields["stands"] == stands
    driving.robot.relatches = False
    assert driving.run(100, resume("in time")).results[0].outcome == Outcome(ResultCode.RESUMED)


def test_tick_resume_tells_what_holds_a_blind_robot(driving: Corridor) -> None:
    driving.run(100, stop())
    driving.robot.infrared_age_s = 1.0
    (result,) = driving.run(100, resume()).results
    assert text_of(result.outcome) == (
        "the robot still stands: its range sensors are silent; check its power and cable"
    )
