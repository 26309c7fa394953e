"""CONTROL in every mode: the examples of docs/the-robot.md, and all that the firmware understands."""

import math

import pytest
from cantools.database import Message
from hypothesis import given
from hypothesis import strategies as st

from hal.codec import InvalidFrameError, load_database
from hal.control import (
    Control,
    Mode,
    RawControl,
    RawSide,
    SpeedControl,
    SystemControl,
    control_frame,
    decode_control,
    encode_brake,
    encode_control,
    set_point,
)
from hal.kurt2_settings import SpeedMode
from hal.robot import WheelSpeeds
from tests.hal.helpers import ROBOT

MOTORS = ROBOT.motors
MESSAGE: Message = load_database().get_message_by_name("CONTROL")

S16 = st.integers(-(2**15), 2**15 - 1)
SIDES = st.builds(RawSide, st.one_of(st.just(0), st.integers(2, 1024)), st.booleans(), st.booleans())
SPEEDS = st.floats(-0.9, 0.9)
SYSTEM_MODES = [mode for mode in Mode if mode >= 0xFF00 and mode is not Mode.UPDATE_ANGLE]
CONTROLS: st.SearchStrategy[Control] = st.one_of(
    st.builds(RawControl, SIDES, SIDES, st.just(Mode.RAW)),
    st.builds(SpeedControl, st.just(Mode.SPEED), S16, S16, st.just(0.0), st.just(True)),
    st.builds(SpeedControl, st.just(Mode.SPEED_CM), S16, S16, st.just(0.0), st.booleans()),
    st.builds(SystemControl, st.sampled_from(SYSTEM_MODES), st.just(0)),
    st.builds(SystemControl, st.just(Mode.UPDATE_ANGLE), st.integers(-(2**31), 2**31 - 1)),
)


def as_cantools_wants_it(control: Control) -> dict[str, int]:
    match control:
        case RawControl(left, right):
            sides = {"LEFT": left, "RIGHT": right}
            values = {f"{name}_PWM": min(1023, 1024 - side.drive) for name, side in sides.items()}
            values |= {f"{name}_BACKWARD": int(side.backward) for name, side in sides.items()}
            values |= {f"{name}_BRAKE": int(side.brake) for name, side in sides.items()}
        case SpeedControl(Mode.SPEED, left, right):
            values = {"LEFT_PERCENT": left, "RIGHT_PERCENT": right}
        case SpeedControl(_, left, right, _, keep):
            values = {"LEFT_CM_S": left, "RIGHT_CM_S": right, "YAW": 0, "YAW_NEGATIVE": 0, "KEEP": int(keep)}
        case SystemControl(Mode.UPDATE_ANGLE, angle):
            values = {"ANGLE": angle}
        case SystemControl():
            values = {"NOTHING": 0}
    return {"MODE": int(control.mode), **values}


@given(CONTROLS)
def test_any_control_survives_the_bus_and_is_what_cantools_makes(control: Control) -> None:
    frame = control_frame(control)
    assert frame.arbitration_id == 0x01
    assert decode_control(frame.data) == control
    assert frame.data == MESSAGE.encode(as_cantools_wants_it(control), scaling=False, strict=False)
    assert MESSAGE.decode(bytes(frame.data), decode_choices=False, scaling=False) == as_cantools_wants_it(control)


@pytest.mark.parametrize(
    ("control", "payload"),
    [
        (RawControl(RawSide(512), RawSide(512)), "00 00 00 02 00 00 02 00"),
        (RawControl(RawSide(0, brake=True), RawSide(0, brake=True)), "00 00 01 03 FF 01 03 FF"),
        (SpeedControl(Mode.SPEED_CM, 50, -50), "00 02 00 32 FF CE 00 01"),
        (SpeedControl(Mode.SPEED, 30, 30), "00 01 00 1E 00 1E 00 00"),
        (SystemControl(Mode.MC_RESET), "FF FF 00 00 00 00 00 00"),
    ],
)
def test_examples_of_the_reference(control: Control, payload: str) -> None:
    assert control_frame(control).data == bytes.fromhex(payload)
    assert decode_control(bytes.fromhex(payload)) == control


def test_brake_is_the_example_of_the_reference() -> None:
    assert encode_brake().data == bytes.fromhex("00000103FF0103FF")


def test_wheel_speeds_are_encoded_in_each_mode() -> None:
    half = WheelSpeeds(0.5, -0.5)
    assert encode_control(SpeedMode.SPEED_CM, half, MOTORS).data == bytes.fromhex("00020032FFCE0001")
    thirty_percent = WheelSpeeds(0.207, 0.207)
    assert encode_control(SpeedMode.SPEED, thirty_percent, MOTORS).data == bytes.fromhex("0001001E001E0000")
    half_drive = WheelSpeeds(0.13, 0.13)
    assert encode_control(SpeedMode.RAW, half_drive, MOTORS).data == bytes.fromhex("0000000200000200")


def test_set_point_truncates_toward_zero_without_rounding_errors() -> None:
    assert set_point(SpeedMode.SPEED_CM, WheelSpeeds(0.009, -0.019), MOTORS) == SpeedControl(Mode.SPEED_CM, 0, -1)
    assert set_point(SpeedMode.SPEED_CM, WheelSpeeds(0.29, -0.57), MOTORS) == SpeedControl(Mode.SPEED_CM, 29, -57)


def test_per_cent_and_drive_end_at_full() -> None:
    assert set_point(SpeedMode.SPEED, WheelSpeeds(0.9, -0.9), MOTORS) == SpeedControl(Mode.SPEED, 100, -100)
    full = set_point(SpeedMode.RAW, WheelSpeeds(3.0, -3.0), MOTORS)
    assert full == RawControl(RawSide(960), RawSide(960, backward=True))


def test_standstill_in_raw_mode_brakes() -> None:
    stand = set_point(SpeedMode.RAW, WheelSpeeds(0.0, 0.0), MOTORS)
    assert stand == RawControl(RawSide(0, brake=True), RawSide(0, brake=True))
    assert stand.wheel_speeds(MOTORS) == (0.0, 0.0)


@given(SPEEDS, SPEEDS, st.sampled_from(SpeedMode))
def test_sent_speed_is_never_faster_nor_much_slower(left: float, right: float, mode: SpeedMode) -> None:
    wanted = WheelSpeeds(left, right)
    control = decode_control(encode_control(mode, wanted, MOTORS).data)
    assert not isinstance(control, SystemControl)
    assert control == set_point(mode, wanted, MOTORS)
    for meant, sent in zip(wanted, control.wheel_speeds(MOTORS), strict=True):
        meant_m_s = min(abs(meant), MOTORS.full_speed_m_s) if mode is SpeedMode.SPEED else abs(meant)
        assert sent * meant >= 0.0
        assert meant_m_s - 0.0101 <= abs(sent) <= meant_m_s + 1e-7


def test_curve_of_the_motors_ends_where_it_ends() -> None:
    full = decode_control(bytes.fromhex("0000000000000000"))
    assert full == RawControl(RawSide(1024), RawSide(1024))
    assert full.wheel_speeds(MOTORS) == (0.91, 0.91)
    none = decode_control(bytes.fromhex("0000000400000FFF"))
    assert none == RawControl(RawSide(0), RawSide(0))
    assert none.wheel_speeds(MOTORS) == (0.0, 0.0)


@pytest.mark.parametrize("yaw_rate_rad_s", [math.pi / 2, -math.pi / 2])
def test_yaw_rate_has_a_sign_bit(yaw_rate_rad_s: float) -> None:
    control = SpeedControl(Mode.SPEED_CM, 0, 0, yaw_rate_rad_s)
    frame = control_frame(control)
    assert frame.data[6:].hex() == ("00c9" if yaw_rate_rad_s > 0 else "00cb")
    back = decode_control(frame.data)
    assert isinstance(back, SpeedControl)
    assert back.yaw_rate_rad_s == pytest.approx(yaw_rate_rad_s)


def test_a_number_too_large_is_refused() -> None:
    with pytest.raises(ValueError, match="SpeedControl"):
        control_frame(SpeedControl(Mode.SPEED_CM, 40_000, 0))


@given(st.binary(max_size=7))
def test_short_frames_are_junk(payload: bytes) -> None:
    with pytest.raises(InvalidFrameError, match="needs 8"):
        decode_control(payload)


@given(st.integers(0, 0xFFFF).filter(lambda number: number not in set(Mode)), st.binary(min_size=6, max_size=6))
def test_unknown_modes_are_junk(number: int, rest: bytes) -> None:
    with pytest.raises(InvalidFrameError, match=f"0x{number:04X} is unknown"):
        decode_control(number.to_bytes(2, "big") + rest)
