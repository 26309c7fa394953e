"""Edge cases of CONTROL: curves without level ends, brakes, and unused numbers."""

import pytest

from hal.control import Mode, RawControl, RawSide, SpeedControl, SystemControl, control_frame, decode_control, set_point
from hal.kurt2_settings import Kurt2MotorSettings, SpeedMode
from hal.robot import WheelSpeeds
from tests.hal.helpers import ROBOT

STEEP = Kurt2MotorSettings(
    **{**ROBOT.motors.model_dump(), "raw_drive": (100, 500, 1000), "raw_speed_m_s": (0.1, 0.3, 0.9)}
)
"""A motor that turns as soon as it is driven, and ever faster up to the end."""


@pytest.mark.parametrize(
    ("speed_m_s", "side"),
    [
        (0.0, RawSide(0, brake=True)),
        (0.05, RawSide(0, brake=True)),  # slower than it can turn: it stands
        (0.2, RawSide(300)),
        (0.3, RawSide(500)),
        (-0.6, RawSide(750, backward=True)),
        (0.9, RawSide(1000)),
        (-5.0, RawSide(1000, backward=True)),
    ],
)
def test_a_speed_is_driven_as_the_curve_says(speed_m_s: float, side: RawSide) -> None:
    assert set_point(SpeedMode.RAW, WheelSpeeds(speed_m_s, 0.0), STEEP) == RawControl(side, RawSide(0, brake=True))


@pytest.mark.parametrize(
    ("side", "speed_m_s"),
    [
        (RawSide(50), 0.1),
        (RawSide(50, brake=True), 0.0),
        (RawSide(100), 0.1),
        (RawSide(300), 0.2),
        (RawSide(300, brake=True), 0.0),
        (RawSide(500, backward=True), -0.3),
        (RawSide(750), 0.6),
        (RawSide(1000), 0.9),
        (RawSide(1024, backward=True), -0.9),
    ],
)
def test_a_drive_turns_as_the_curve_says_unless_it_is_braked(side: RawSide, speed_m_s: float) -> None:
    assert RawControl(side, RawSide(0, brake=True)).wheel_speeds(STEEP) == pytest.approx((speed_m_s, 0.0))


def test_curve_ends_equal_the_settings_exactly() -> None:
    assert RawControl(RawSide(100), RawSide(1000)).wheel_speeds(STEEP) == (0.1, 0.9)


@pytest.mark.parametrize(
    ("yaw_rate_rad_s", "keep", "rest"),
    [(3.0, True, (95 << 2) | 1), (-3.0, True, (95 << 2) | 3), (-3.0, False, (95 << 2) | 2), (0.0, False, 0)],
)
def test_the_yaw_rate_stands_above_its_sign_and_keep(yaw_rate_rad_s: float, keep: bool, rest: int) -> None:
    frame = control_frame(SpeedControl(Mode.SPEED_CM, 0, 0, yaw_rate_rad_s, keep))
    assert frame.data[6:] == rest.to_bytes(2, "big")


def test_only_an_angle_comes_with_a_number() -> None:
    data = control_frame(SystemControl(Mode.UPDATE_ANGLE, 7)).data
    assert decode_control(data) == SystemControl(Mode.UPDATE_ANGLE, 7)
    assert decode_control(b"\xff\x03" + data[2:]) == SystemControl(Mode.RESET_GYRO, 0)
