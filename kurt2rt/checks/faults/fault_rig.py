"""Protocols of the rigs for fault drill and soak: a robot in simulated time with faults."""

from collections.abc import Callable
from typing import Protocol

from hal.kurt2 import Kurt2
from hal.tap import Tap
from kurt2rt.checks.faults.table import Kind


class SimulatedTime(Protocol):
    """Simulated time that advances on request, with scheduled events."""

    def now_s(self) -> float:
        """Return the present simulated time in s."""
        ...

    def at(self, time_s: float, act: Callable[[], None]) -> None:
        """Call `act` once, when simulated time reaches `time_s`, in s."""
        ...

    def every(self, period_s: float, first_s: float, act: Callable[[], None]) -> None:
        """Call `act` at `first_s` and then each `period_s`, both in s of simulated time, without end."""
        ...

    def run_until(self, time_s: float) -> None:
        """Advance the world and the watchdog to a time in s."""
        ...


class RigDisturbance(Protocol):
    """Fault with its time span."""

    @property
    def kind(self) -> Kind:
        """Kind of the fault."""
        ...

    @property
    def begin_s(self) -> float:
        """Begin of the fault, in s of simulated time."""
        ...

    @property
    def end_s(self) -> float:
        """End of the fault, in s of simulated time."""
        ...

    @property
    def period_s(self) -> float:
        """Interval between two outputs (kind slow), or span of each failure and recovery (intermittent), in s."""
        ...

    @property
    def delay_s(self) -> float:
        """Delay that the fault adds, or duration of each blocking call, in s."""
        ...

    def acts(self, now_s: float) -> bool:
        """Return whether the fault is active at `now_s`, in s of simulated time."""
        ...


class BusRig(Protocol):
    """Robot, bus and driver."""

    on_sent: Callable[[int, bytes], None]
    """Callback with number and payload of each CONTROL that a driver hands to its bus."""

    @property
    def time(self) -> SimulatedTime:
        """Simulated time of robot, bus and driver."""
        ...

    @property
    def robot(self) -> Kurt2 | None:
        """Present driver; None between two drivers."""
        ...

    def close(self) -> None:
        """Close driver and bus."""
        ...


class FaultRig(BusRig, Protocol):
    """Robot, bus and driver with one fault."""

    on_control: Callable[[int, bytes], None]
    """Callback with number and payload of each CONTROL that arrives at the robot."""

    @property
    def disturbance(self) -> RigDisturbance:
        """Fault of this rig."""
        ...

    @property
    def robot(self) -> Kurt2:
        """Present driver."""
        ...

    def restart_driver(self) -> Kurt2:
        """Replace the driver by a new one, like a restart of its process; return the new driver."""
        ...

    def attach_tap(self, tap: Tap) -> None:
        """Let `tap` see each frame that passes the driver's interface."""
        ...


class RigFactory(Protocol):
    """Factory of rigs."""

    def open(
        self, target: str, kind: Kind, *, begin_s: float, end_s: float, period_s: float, delay_s: float, seed: int
    ) -> FaultRig:
        """Return a rig in which `target` has a fault from `begin_s` to `end_s`.

        A target that is no part of robot or bus is left to the caller. Times in s; `period_s` and `delay_s` are those
        of the fault's kind. `seed`: noise and phases.
        """
        ...
