"""Simulated robot behind the driver of the real robot."""

import itertools
from collections.abc import Iterator

import pytest

from hal.bus import open_bus
from hal.guard_reason import GuardReason
from hal.kurt2 import Kurt2
from hal.kurt2_settings import SpeedMode, load_kurt2
from hal.robot import STANDSTILL, SensorReadings, WheelSpeeds
from simbridge.simulated_robot import SimulatedKurt2
from tests.simbridge.rig import facing_wall, room

_numbers = itertools.count()
Pair = tuple[Kurt2, SimulatedKurt2]


@pytest.fixture(params=list(SpeedMode))
def pair(request: pytest.FixtureRequest) -> Iterator[Pair]:
    """Return driver and simulated robot on one bus, in each speed mode."""
    settings = load_kurt2()
    settings = settings.model_copy(update={"can": settings.can.model_copy(update={"speed_mode": request.param})})
    name = f"virtual:simbridge-driver-{next(_numbers)}"
    far_end = open_bus(name)
    kurt2 = Kurt2(settings, open_bus(name))
    yield kurt2, SimulatedKurt2(settings, room(), far_end, seed=3)
    kurt2.close()
    far_end.shutdown()


def drive(pair: Pair, wanted: WheelSpeeds, seconds: float) -> SensorReadings:
    kurt2, simulated = pair
    for _ in range(round(seconds / 0.01)):
        simulated.step()
        now_s = simulated.time_s
        readings = kurt2.sense(now_s)
        kurt2.drive(wanted, now_s, now_s)
    return readings


def test_driver_speed_jump_never_crashes_the_controller(pair: Pair) -> None:
    kurt2, simulated = pair
    for wanted in (WheelSpeeds(0.6, 0.6), STANDSTILL, WheelSpeeds(-0.6, -0.6), WheelSpeeds(0.6, -0.6), STANDSTILL):
        drive(pair, wanted, 0.8)
        assert not simulated.controller.crashed
    assert kurt2.health.junk == 0


def test_driver_bumper_stops_the_robot(pair: Pair) -> None:
    pair[1].place(facing_wall(0.3))
    readings = drive(pair, WheelSpeeds(0.3, 0.3), 3.0)
    assert readings.bumpers == 0b000111
    assert readings.encoder_left_ticks == 0
    assert pair[1].collisions == 1


def test_driver_emergency_stop_brakes_and_holds(pair: Pair) -> None:
    drive(pair, WheelSpeeds(0.3, 0.3), 1.0)
    pair[0].emergency_stop(GuardReason.PROGRAM_WAITS)
    readings = drive(pair, WheelSpeeds(0.3, 0.3), 1.0)
    assert (readings.encoder_left_ticks, readings.encoder_right_ticks) == (0, 0)
