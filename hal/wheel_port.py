"""Port through which the guard sends set points, over whatever link a robot has."""

from typing import NamedTuple, Protocol

from hal.robot import WheelSpeeds


class WheelCommand(NamedTuple):
    """Set points as a message of the link; made once, then sent in each tick until they change."""

    message: object
    """Message in the form of its link, such as a CAN frame."""
    applied: WheelSpeeds
    """Set points in m/s that the message carries: those that were asked for, to the resolution of the link."""


class WheelPort(Protocol):
    """Output port of a guard over any link: the only way to a robot's wheels.

    Only a guard has one, so no set point reaches a motor without its rules. A kind of robot implements it.
    """

    @property
    def name(self) -> str:
        """Name of the link in messages, such as `bus can0`."""
        ...

    @property
    def remedy(self) -> str:
        """Advice for messages that are not carried, such as `check the cable`."""
        ...

    @property
    def brake(self) -> object:
        """Message that stops both sides as hard as the robot can."""
        ...

    @property
    def unconfirmed(self) -> int:
        """Own messages known to be not yet carried; 0 over a link that does not tell."""
        ...

    def forget_unconfirmed(self) -> None:
        """Count unconfirmed messages from 0 again."""
        ...

    def command(self, speeds: WheelSpeeds) -> WheelCommand:
        """Return the message of finite set points in m/s, at most the robot's highest speed."""
        ...

    def send(self, message: object) -> None:
        """Send the brake or a command's message without waiting. Raises hal.bus.BusError."""
        ...
