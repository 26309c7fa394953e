"""The library's simulated robot over the kernel's own CAN."""

import can
import pytest

import kurt2rt

pytestmark = pytest.mark.hil


@pytest.mark.kurt2(world="a", seed=1)
def test_kurt2_on_vcan_drives_as_on_a_bus_of_its_own(
    vcan0: str, kurt2_on_vcan: kurt2rt.SimulatedRobot, kurt2: kurt2rt.SimulatedRobot
) -> None:
    with can.Bus(vcan0, interface="socketcan") as bus:
        for robot in (kurt2_on_vcan, kurt2):
            robot.teach("forward")
            robot.step(100)
        heard = {frame.arbitration_id for frame in iter(lambda: bus.recv(0.0), None)}
    assert kurt2_on_vcan.pose == kurt2.pose
    assert {0x01, 0x05, 0x09} <= heard  # CONTROL, infra-red, encoders
