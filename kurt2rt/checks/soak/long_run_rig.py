"""What a soak needs of the place where it happens: a robot in simulated time on which anything may fail."""

from collections.abc import Callable
from typing import Protocol

from hal.kurt2 import Kurt2
from hal.tap import Tap
from kurt2rt.checks.faults.fault_rig import RigDisturbance, SimulatedTime
from kurt2rt.checks.faults.table import Kind


class SoakRig(Protocol):
    """Robot, bus and driver, one driver after another."""

    on_sent: Callable[[int, bytes], None]
    """Called with number and payload of each CONTROL that a driver hands to its bus."""
    on_control: Callable[[int, bytes, float], None]
    """Called for each of them that the robot takes, with the same number and the time of its arrival in s."""
    turned_m: list[float]
    """Way of the rims so far, left and right, forward counts positive."""
    crashes: int
    """How often the robot's controller went dead and was switched off and on."""
    robot: Kurt2 | None
    """The driver that is there now."""

    @property
    def time(self) -> SimulatedTime:
        """The time of all of it."""
        ...

    @property
    def position_m(self) -> tuple[float, float]:
        """Where the robot really is."""
        ...

    @property
    def collisions(self) -> int:
        """Contacts so far."""
        ...

    def start_driver(self, wire: str) -> Kurt2:
        """A driver that knows nothing comes to the bus, over a wire by name or `none`."""
        ...

    def end_driver(self) -> None:
        """The driver's process is over."""
        ...

    def begin(
        self, target: str, kind: Kind, *, begin_s: float, end_s: float, period_s: float, delay_s: float
    ) -> RigDisturbance:
        """Something is going to fail; one that is no part of robot or bus is left to the caller."""
        ...

    def end(self) -> None:
        """All is well again."""
        ...

    def attach_tap(self, tap: Tap | None) -> None:
        """Somebody looks on at the driver's end of the bus; None: nobody."""
        ...

    def reposition(self) -> None:
        """Somebody sets the robot down at a start pose."""
        ...

    def power_cycle(self) -> None:
        """Somebody switches the robot's controller off and on."""
        ...

    def close(self) -> None:
        """Give the bus back."""
        ...
