"""Protocol of the rig for a soak: a robot in simulated time with changing faults."""

from collections.abc import Callable
from typing import Protocol

from hal.kurt2 import Kurt2
from hal.tap import Tap
from kurt2rt.checks.faults.fault_rig import BusRig, RigDisturbance
from kurt2rt.checks.faults.table import Kind


class SoakRig(BusRig, Protocol):
    """Robot, bus and a sequence of drivers."""

    on_control: Callable[[int, bytes, float], None]
    """Callback with number, payload and arrival time in s of each CONTROL that the robot receives."""
    turned_m: list[float]
    """Distance rolled by the rims, left and right, forward positive."""
    crashes: int
    """Crashes of the robot's controller, each followed by a power cycle."""

    @property
    def position_m(self) -> tuple[float, float]:
        """True position (x, y) of the robot in m."""
        ...

    @property
    def collisions(self) -> int:
        """Number of contacts with walls and obstacles so far."""
        ...

    def start_driver(self, wire: str) -> Kurt2:
        """Start a new driver over a wire given by name and return it."""
        ...

    def end_driver(self) -> None:
        """End the driver, like the end of its process."""
        ...

    def begin(
        self, target: str, kind: Kind, *, begin_s: float, end_s: float, period_s: float, delay_s: float
    ) -> RigDisturbance:
        """Schedule a fault of `target` from `begin_s` to `end_s` and return it. Times in s of simulated time.

        A target that is no part of robot or bus is left to the caller. `period_s` and `delay_s` are those of the
        fault's kind.
        """
        ...

    def end(self) -> None:
        """Remove the fault from robot and bus."""
        ...

    def attach_tap(self, tap: Tap | None) -> None:
        """Attach a tap to the driver's interface; None detaches it."""
        ...

    def reposition(self) -> None:
        """Reposition the robot at a start pose."""
        ...

    def power_cycle(self) -> None:
        """Switch the robot's controller off and on."""
        ...
