"""Electronics of a simulated robot: what it does in each cycle at its end of the link."""

from collections.abc import Sequence
from typing import NamedTuple, Protocol


class MotorCommands(NamedTuple):
    """Set points and brakes that a simulated robot's electronics give its motors in one cycle."""

    left_m_s: float
    right_m_s: float
    left_brake: bool = False
    right_brake: bool = False


MOTORS_OFF = MotorCommands(0.0, 0.0)
MOTORS_BRAKED = MotorCommands(0.0, 0.0, left_brake=True, right_brake=True)


class Controller(Protocol):
    """Electronics of a simulated robot at its end of the link: once a cycle, set points in, reports out."""

    @property
    def commands(self) -> MotorCommands:
        """Commands for the motors in this cycle."""
        ...

    @property
    def crashed(self) -> bool:
        """Return whether the electronics has crashed, and needs a reset."""
        ...

    @property
    def control_frames(self) -> int:
        """Number of valid commands since power-on."""
        ...

    @property
    def junk_frames(self) -> int:
        """Number of invalid messages since power-on."""
        ...

    @property
    def watchdog_expired(self) -> bool:
        """Return whether no valid set point has arrived for the time of the controller's own watchdog."""
        ...

    @property
    def state(self) -> tuple[int, ...]:
        """All that decides the next cycle, besides the present commands, as numbers for the state hash."""
        ...

    def receive(self) -> None:
        """Run the first half of a cycle: read the link, command the motors. Raises hal.bus.BusError."""
        ...

    def update_readings(self, fresh: Sequence[int], counts: Sequence[int]) -> None:
        """Apply new sensor readings.

        `fresh`: indexes of sensors with new readings. `counts`: readings of all sensors, in counts.
        """
        ...

    def send(self, left_ticks: int, right_ticks: int, bumpers: int) -> None:
        """Run the second half of a cycle: send reports.

        `left_ticks`, `right_ticks`: encoder ticks of this cycle, forward positive. `bumpers`: bit n is set if bumper n
        touches. Raises hal.bus.BusError.
        """
        ...

    def power_cycle(self) -> None:
        """Switch off and on: brakes until the next set point."""
        ...
