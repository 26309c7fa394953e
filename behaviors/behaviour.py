"""The contract of everything that can stand as an action in an RLA."""

from typing import Protocol

from hal.robot import SensorReadings, WheelSpeeds


class Behaviour(Protocol):
    """An action of the repertoire. Its state is its own and begins anew with `start`."""

    @property
    def finished(self) -> bool:
        """Whether it has done what it was started for; it stands then, and yields to another one at once."""
        ...

    @property
    def lost(self) -> bool:
        """Whether it does not know how to go on; it stands then, and whoever chose it asks."""
        ...

    def start(self) -> None:
        """Called in the tick in which this behaviour takes the wheels over from another one."""
        ...

    def step(self, senses: SensorReadings) -> WheelSpeeds:
        """Wheel speeds for this tick; called once per tick while it is active."""
        ...
