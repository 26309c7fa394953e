"""Port of KURT2's wheels: set points as CONTROL frames on a CAN bus."""

from typing import cast

from hal.bus import CanBus
from hal.control import control_frame, encode_brake, set_point
from hal.frame import Frame
from hal.kurt2_settings import Kurt2Settings
from hal.robot import WheelSpeeds
from hal.wheel_port import WheelCommand


class CanWheelPort:
    """Sender of CONTROL (hal.wheel_port.WheelPort), in the speed mode of the robot's settings."""

    remedy = "switch the robot on, check cable and bit rate"

    def __init__(self, settings: Kurt2Settings, bus: CanBus) -> None:
        """Take the bus's CONTROL port. Raises hal.bus.BusError if another guard has it."""
        self._port = bus.control_port()
        self.name = f"bus {bus.name}"
        self.brake: Frame = encode_brake()
        self._mode = settings.can.speed_mode
        self._motors = settings.motors

    @property
    def unconfirmed(self) -> int:
        """Own CONTROL frames that the bus had not carried at the last drain."""
        return self._port.unconfirmed

    def forget_unconfirmed(self) -> None:
        """Count unconfirmed frames from 0 again, because frames that were lost silently are never confirmed."""
        self._port.forget_unconfirmed()

    def command(self, speeds: WheelSpeeds) -> WheelCommand:
        """Return the CONTROL frame of finite set points in m/s, truncated to the resolution of the mode."""
        point = set_point(self._mode, speeds, self._motors)
        return WheelCommand(control_frame(point), point.wheel_speeds(self._motors))

    def send(self, message: object) -> None:
        """Send a CONTROL frame of this port without waiting. Raises hal.bus.BusError."""
        self._port.send(cast("Frame", message))
