"""Health counters of the robot and its bus."""

from dataclasses import dataclass

from hal.bus_state import ControllerState
from hal.guard_reason import GuardReason


@dataclass(frozen=True, slots=True)
class Health:
    """Counters of frames and errors since the robot was opened, and faults (`GuardedRobot.health`)."""

    frames: int
    """Frames received of those that the robot listens to, and error frames."""
    junk: int
    """Invalid frames: too short, a count above 1023, remote or extended."""
    error_frames: int
    """Error frames of this machine's CAN controller."""
    foreign_control: int
    """CONTROL frames of another sender on the bus."""
    send_failures: int
    """CONTROL frames that the bus did not take."""
    receive_failures: int
    """Drains that the bus refused."""
    bus_trouble: str
    """Newest error of receiving or sending, with its remedy; empty if there was none since the last release."""
    controller: ControllerState
    """Error state of this machine's CAN controller."""
    controller_trouble: str
    """Fault of the controller, with its remedy; empty while error-active. Only bus-off stops the robot."""
    alarm: str
    """Cause of a stop by wheels, sensors or another sender, with its remedy; empty after a release."""
    latched: GuardReason | None
    """Why the robot stays stopped until `release`; None when it does not."""
    notice: str = ""
    """Cause why readings do not arrive or do not count; empty while all is well. It stops nothing by itself."""

    @property
    def trouble(self) -> str:
        """Most important fault, with its remedy, in one line; empty without a fault."""
        if self.latched is None:
            return self.controller_trouble or self.notice
        return self.controller_trouble or self.bus_trouble or self.alarm or self.notice
