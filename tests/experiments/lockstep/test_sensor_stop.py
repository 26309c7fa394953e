"""Times of a lesson's stop for a broken sensor."""

import pytest

from kurt2rt.core.decision.active_stop import ActiveStop, StopReason
from kurt2rt.experiments.lockstep.sensor_stop import SensorStopAct, SensorStopTimer

BROKEN = ActiveStop(StopReason.SENSOR_BROKEN)
TICKS_PER_SECOND = 10


def acts_at(stops: list[ActiveStop | None]) -> dict[int, SensorStopAct]:
    timer = SensorStopTimer(TICKS_PER_SECOND)
    acts = {tick: timer.update(stop) for tick, stop in enumerate(stops, start=1)}
    return {tick: act for tick, act in acts.items() if act is not None}


def test_sensor_stop_robot_is_carried_away_then_sent_on() -> None:
    assert acts_at([BROKEN] * 40) == {10: SensorStopAct.CARRY_AWAY, 20: SensorStopAct.RESUME}


def test_sensor_stop_that_ends_begins_again_at_the_next() -> None:
    assert acts_at([BROKEN] * 9 + [None] + [BROKEN] * 10) == {20: SensorStopAct.CARRY_AWAY}


@pytest.mark.parametrize("reason", [each for each in StopReason if each is not StopReason.SENSOR_BROKEN])
def test_sensor_stop_other_reasons_are_left_to_the_teacher(reason: StopReason) -> None:
    assert acts_at([ActiveStop(reason)] * 40) == {}
