"""The far end of the bus, as the tests of hal see it."""

import itertools
from collections.abc import Iterable

import can

from hal.bus import CanBus, open_bus
from hal.can_wheel_port import CanWheelPort
from hal.codec import Codec, load_codec
from hal.control import Control, decode_control
from hal.frame import Frame
from hal.guard import Guard
from hal.kurt2_settings import Kurt2Settings, load_kurt2
from hal.robot import SensorReadings
from hal.robot_settings import GuardSettings

CODEC: Codec = load_codec()
ROBOT: Kurt2Settings = load_kurt2()
SENSORS = ROBOT.infrared.sensors
INFRARED_FRAMES = ("ADC00_03", "ADC04_07", "ADC08_11", "BDC00_03", "BDC04_07")
TICK_S = ROBOT.cycle_s

_numbers = itertools.count()


def bus_pair() -> tuple[CanBus, CanBus]:
    """Both ends of an in-process bus of its own: the robot's, and that of the controller."""
    name = f"virtual:hal-test-{next(_numbers)}"
    return open_bus(name), open_bus(name)


def guard_on(robot: Kurt2Settings, bus: CanBus) -> Guard:
    """Return the guard of a robot on a bus."""
    return Guard(robot, CanWheelPort(robot, bus))


def cycle(counts: int = 200, left_ticks: int = 0, right_ticks: int = 0, bumpers: int = 0) -> list[Frame]:
    """One cycle of what the controller sends, the same count on every channel."""
    frames = [CODEC.message(name).pack(counts, counts, counts, counts) for name in INFRARED_FRAMES]
    encoder = CODEC.message("ENCODER").pack(left_ticks, right_ticks)
    return [*frames, encoder, CODEC.message("BUMPERC").pack(bumpers, 0)]


def ticks(speed_m_s: float) -> int:
    """Return the encoder ticks of a cycle at this speed."""
    return round(speed_m_s * TICK_S / ROBOT.geometry.metres_per_tick)


def error_frame(classes: int, *, status: int = 0, sending: int = 0, receiving: int = 0) -> can.Message:
    """Return an error frame of an adapter: classes of linux/can/error.h, status of the controller, and its counters."""
    data = bytes((0, status, 0, 0, 0, 0, sending, receiving))
    return can.Message(
        arbitration_id=classes, is_extended_id=classes > 0x7FF, is_error_frame=True, data=data, check=True
    )


def send(bus: CanBus, frames: Iterable[can.Message]) -> None:
    port = bus.telemetry_port()
    for frame in frames:
        port.send(frame)


def controls(bus: CanBus) -> list[Control]:
    """Return the CONTROL values since the last call."""
    return [decode_control(message.data) for message in bus.drain()]


def fresh(
    time_s: float, bumpers: int = 0, infrared_age_s: float = 0.0, encoder_age_s: float = 0.0, bumper_age_s: float = 0.0
) -> SensorReadings:
    return SensorReadings(time_s, (200,) * len(SENSORS), infrared_age_s, 0, 0, encoder_age_s, bumpers, bumper_age_s)


def robot_with(**limits: float) -> Kurt2Settings:
    """Return the shipped robot with other guard settings."""
    guard = GuardSettings(**{**ROBOT.guard.model_dump(), **limits})
    return ROBOT.model_copy(update={"guard": guard})


def pull_the_plug(bus: CanBus) -> None:
    """Remove the adapter: python-can's bus fails from now on, unknown to CanBus."""
    assert bus._can_interface is not None
    bus._can_interface.shutdown()
