"""Simulated robot behind the driver of the real robot."""

import itertools
from collections.abc import Iterator

import pytest

from hal.bus import open_bus
from hal.kurt2 import Kurt2
from hal.kurt2_settings import SpeedMode, load_kurt2
from hal.robot import STANDSTILL, WheelSpeeds
from simbridge.simulated_robot import SimulatedKurt2
from tests.simbridge.rig import room

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


def test_driver_speed_jump_never_crashes_the_controller(pair: Pair) -> None:
    kurt2, simulated = pair
    for wanted in (WheelSpeeds(0.6, 0.6), STANDSTILL, WheelSpeeds(-0.6, -0.6), WheelSpeeds(0.6, -0.6), STANDSTILL):
        for _ in range(80):
            simulated.step()
            now_s = simulated.time_s
            kurt2.sense(now_s)
            kurt2.drive(wanted, now_s, now_s)
        assert not simulated.controller.crashed
    assert kurt2.health.junk == 0
