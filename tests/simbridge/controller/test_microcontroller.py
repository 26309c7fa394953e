"""Simulated micro-controllers: CONTROL, watchdog, crash, telemetry."""

import can
import pytest

from config.settings import SettingsError
from hal.control import Mode, RawControl, RawSide, SpeedControl, SystemControl
from simbridge.contracts.simulation import Pose
from simbridge.simulated_robot import SimulatedKurt2
from tests.simbridge.rig import ROBOT, STAND, Rig, room

FORWARD = SpeedControl(Mode.SPEED_CM, 30, 30)
RESET = SystemControl(Mode.MC_RESET)


def control(payload: str) -> can.Message:
    return can.Message(arbitration_id=0x01, is_extended_id=False, data=bytes.fromhex(payload))


def test_watchdog_without_control_cuts_the_motors(rig: Rig) -> None:
    rig.run(1.0, FORWARD)
    rig.run(0.19)
    assert rig.speed_m_s == pytest.approx(0.30, abs=0.01)
    rig.run(0.12)
    assert rig.speed_m_s == 0.0
    rig.drive(30, 30, 1.0)
    assert rig.speed_m_s == pytest.approx(0.30, abs=0.01)


def test_control_invalid_frames_are_only_counted(rig: Rig) -> None:
    invalid = [
        control("0007003200320001"),  # unknown mode
        control("00020032003200"),  # seven bytes
        control(""),
        can.Message(arbitration_id=0x01, is_extended_id=False, is_remote_frame=True, dlc=8),
    ]
    for repetitions in (1, 8):
        for message in invalid * repetitions:
            rig._control_port.send(message)
            rig.step()
        assert rig.heard["ENCODER"] == (0, 0)  # neither a set point nor fed to the watchdog
        rig.run(1.0, FORWARD)
    assert rig.robot.controller.junk_frames == 9 * len(invalid)


@pytest.mark.parametrize(
    "jump",
    [SpeedControl(Mode.SPEED_CM, 60, 60), SpeedControl(Mode.SPEED_CM, 0, 60), RawControl(RawSide(1000), RawSide(1000))],
)
def test_control_jump_crashes_the_controller_until_reset(jump: SpeedControl | RawControl, rig: Rig) -> None:
    rig.run(0.1, STAND)
    rig.run(1.0, jump)
    assert rig.robot.controller.crashed
    assert rig.frames == 0
    assert rig.robot.pose == Pose(2.0, 2.0, 0.0)
    rig.tell(SystemControl(Mode.ACTUATOR_ON))
    rig.run(0.5, FORWARD)
    assert rig.frames == 0
    rig.step(RESET)
    rig.drive(30, 30, 1.0)
    assert rig.frames > 0
    assert rig.speed_m_s == pytest.approx(0.30, abs=0.01)


def test_control_stop_from_full_speed_is_no_crash(rig: Rig) -> None:
    rig.robot.place(Pose(0.5, 2.0, 0.0))
    rig.drive(80, 80, 1.0)
    rig.run(1.0, STAND)
    assert not rig.robot.controller.crashed
    assert rig.heard["ENCODER"] == (0, 0) or abs(rig.speed_m_s) < 0.001


def test_actuators_off_holds_the_motors_until_on(rig: Rig) -> None:
    rig.run(1.0, FORWARD)
    rig.tell(SystemControl(Mode.ACTUATOR_OFF))
    rig.run(1.5, FORWARD)
    assert abs(rig.speed_m_s) < 0.001
    rig.tell(SystemControl(Mode.ACTUATOR_ON))
    rig.run(1.0, FORWARD)
    assert rig.speed_m_s == pytest.approx(0.30, abs=0.01)


def test_instruments_execute_their_commands(rig: Rig) -> None:
    rig.drive(-10, 10, 3.0)
    rig.drive(0, 0, 0.5)
    for command in (
        SystemControl(Mode.RESET_GYRO),
        SystemControl(Mode.CALIBRATE_GYRO),
        SystemControl(Mode.UPDATE_ANGLE, 1_000_000),
        SystemControl(Mode.RESET_SSC),
    ):
        rig.step(command)
    rig.drive(0, 0, 0.2)
    assert abs(rig.heard["GYRO_MC1"][0] / 4992511) < 0.2
    assert rig.heard["DEADRECK"][2] == pytest.approx(5730, abs=10)


def test_analog_frames_sensor_on_another_channel_is_refused(rig: Rig) -> None:
    wrong = ROBOT.infrared.sensors[0].model_copy(update={"channel": "ADC12"})
    infrared = ROBOT.infrared.model_copy(update={"sensors": (wrong, *ROBOT.infrared.sensors[1:])})
    with pytest.raises(SettingsError, match=r"s1.*ADC12"):
        SimulatedKurt2(ROBOT.model_copy(update={"infrared": infrared}), room(), rig.robot_end, 1)
