"""Link to a robot without CAN: what a plug-in's driver has to provide, and the reports that arrive over it."""

from collections.abc import Sequence
from typing import NamedTuple, Protocol

from hal.robot import WheelSpeeds


class RangeReport(NamedTuple):
    """Readings of some sensors that follow each other in the sensor table."""

    at_s: float
    """Time of the measurement on the runtime's clock; the time of arrival where the link has no clock."""
    first: int
    """Place of the first one in the sensor table."""
    counts: tuple[int, ...]
    """Readings in counts from 0 to 1023, the higher the nearer."""


class WheelReport(NamedTuple):
    """Encoder ticks of both sides since the previous report, as a link without CAN delivers them."""

    at_s: float
    """Time of the measurement on the runtime's clock."""
    left_ticks: int
    """Ticks of the left side, forward positive."""
    right_ticks: int
    duration_s: float
    """Time since the previous report, in s; 0 for the first one, whose ticks say nothing about a speed."""


class BumperReport(NamedTuple):
    """State of all bumpers at one time, as a link without CAN delivers it."""

    at_s: float
    """Time of the measurement on the runtime's clock."""
    pressed: int
    """Bit n set: bumper n of the robot's table is pressed."""


class ForeignCommandReport(NamedTuple):
    """Command of another sender, which the robot's wheels may follow."""

    at_s: float


class AlarmReport(NamedTuple):
    """Fault that the robot tells of itself, such as a hot motor. It lasts until a report without a text."""

    at_s: float
    text: str
    """Sentence for the user; empty: there is no fault any more."""


class NoticeReport(NamedTuple):
    """Cause, for the user, why readings do not arrive or do not count. It stops nothing: the readings grow old."""

    at_s: float
    text: str
    """Sentence that lasts until the next report; empty: all is well."""


Report = RangeReport | WheelReport | BumperReport | ForeignCommandReport | AlarmReport | NoticeReport


class RobotLink(Protocol):
    """Transport to a robot without CAN: reports come in, set points go out. Nothing here waits.

    A plug-in implements it, for example over a serial line; `LinkedRobot` puts guard and watchdog in front of it.

    A message that cannot be read raises nothing: the link counts it as `junk`, and its readings age until the guard
    stops the robot.
    """

    name: str
    """Name in messages, such as `serial port /dev/ttyACM0`."""
    remedy: str
    """Advice for messages that are not carried, such as `check the cable`."""

    @property
    def junk(self) -> int:
        """Messages so far that could not be read."""
        ...

    @property
    def unconfirmed(self) -> int:
        """Own commands known to be not yet carried; 0 if the link does not tell."""
        ...

    def receive(self, now_s: float) -> Sequence[Report]:
        """Return all reports that arrived, oldest first; `now_s` on the runtime's clock.

        Raises hal.bus.BusError on every call after the link was lost, so silence is never taken for a quiet robot.
        """
        ...

    def applied(self, speeds: WheelSpeeds) -> WheelSpeeds:
        """Return set points in m/s to the resolution and the limits of the link, never above those that were given."""
        ...

    def send(self, speeds: WheelSpeeds) -> None:
        """Send finite set points in m/s. Raises hal.bus.BusError."""
        ...

    def brake(self) -> None:
        """Stop both sides as hard as the robot can. Raises hal.bus.BusError. Callable from any thread."""
        ...

    def forget_unconfirmed(self) -> None:
        """Count unconfirmed commands from 0 again."""
        ...

    def reopen(self) -> None:
        """Open the link again. Raises hal.bus.BusError while it is still lost."""
        ...

    def close(self) -> None:
        """Close the link; may be called twice."""
        ...
