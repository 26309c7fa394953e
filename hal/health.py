"""Counters that say how well the robot's bus is."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Health:
    """What came and went on the bus since the robot was opened."""

    frames: int
    """Frames received, of every kind."""
    junk: int
    """Refused: too short, a count above 1023, error, remote or extended frames."""
    unknown: int
    """Ignored: identifiers that are not in the CAN database."""
    foreign_control: int
    """CONTROL frames from somebody else on the bus: two masters fight over the wheels."""
    send_failures: int
    """CONTROL frames that the bus did not take."""
    receive_failures: int
    """Drains that the bus refused."""
    bus_trouble: str
    """Newest error of the bus; empty when there was none."""
    latched: str | None
    """Why the robot stays stopped until `release`; None when it does not."""
