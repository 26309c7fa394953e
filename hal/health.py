"""Counters that say how well the robot and its bus are."""

from dataclasses import dataclass

from hal.bus_state import ControllerState
from hal.guard_reason import GuardReason


@dataclass(frozen=True, slots=True)
class Health:
    """What came and went on the bus since the robot was opened, and what is wrong now."""

    frames: int
    """Frames received of those that the robot listens to, and error frames."""
    junk: int
    """Refused: too short, a count above 1023, remote or extended frames."""
    error_frames: int
    """What the CAN controller of this machine had to say about itself and the bus."""
    foreign_control: int
    """CONTROL frames from somebody else on the bus: two masters fight over the wheels."""
    send_failures: int
    """CONTROL frames that the bus did not take."""
    receive_failures: int
    """Drains that the bus refused."""
    bus_trouble: str
    """Newest error of receiving or sending, and what to do; empty when there was none since the last release."""
    controller: ControllerState
    """Of this machine's CAN controller."""
    controller_trouble: str
    """What it suffers from and what to do; empty while it is error-active. It may drive on but for bus-off."""
    alarm: str
    """What made the robot stop itself, and what to do: wheels, sensors, another sender; empty after a release."""
    latched: GuardReason | None
    """Why the robot stays stopped until `release`; None when it does not."""

    @property
    def trouble(self) -> str:
        """What is wrong and what to do, the most important of it in a line; empty when nothing is."""
        if self.latched is None:
            return self.controller_trouble
        return self.controller_trouble or self.bus_trouble or self.alarm
