"""Protocols of the rigs for fault drill and soak: a robot in simulated time with faults."""

from collections.abc import Callable
from typing import Protocol

from hal.kurt2 import Kurt2
from hal.tap import Tap
from kurt2rt.checks.faults.table import Kind


class SimulatedTime(Protocol):
    """Simulated time that advances on request, with scheduled events."""

    def now_s(self) -> float:
        """Return the present in seconds."""
        ...

    def at(self, time_s: float, act: Callable[[], None]) -> None:
        """Schedule a call at a time in s."""
        ...

    def every(self, period_s: float, first_s: float, act: Callable[[], None]) -> None:
        """Schedule a periodic call, times in s."""
        ...

    def run_until(self, time_s: float) -> None:
        """Advance the world and the watchdog to a time in s."""
        ...


class RigDisturbance(Protocol):
    """Fault with its time span."""

    @property
    def kind(self) -> Kind:
        """Return the kind of fault."""
        ...

    @property
    def begin_s(self) -> float:
        """Return the start."""
        ...

    @property
    def end_s(self) -> float:
        """Return the end."""
        ...

    @property
    def period_s(self) -> float:
        """Return the period of CaseSettings."""
        ...

    @property
    def delay_s(self) -> float:
        """Return the delay of CaseSettings."""
        ...

    def acts(self, now_s: float) -> bool:
        """Return whether the fault is active at this time in s."""
        ...


class BusRig(Protocol):
    """Robot, bus and driver."""

    on_sent: Callable[[int, bytes], None]
    """Callback with number and payload of each CONTROL that a driver hands to its bus."""

    @property
    def time(self) -> SimulatedTime:
        """Return the simulated time."""
        ...

    @property
    def robot(self) -> Kurt2 | None:
        """Return the present driver; None between two drivers."""
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
        """Return the fault."""
        ...

    @property
    def robot(self) -> Kurt2:
        """Return the present driver."""
        ...

    def restart_driver(self) -> Kurt2:
        """Replace the driver by a new one, like a restart of its process."""
        ...

    def attach_tap(self, tap: Tap) -> None:
        """Attach a tap to the driver's interface."""
        ...


class RigFactory(Protocol):
    """Factory of rigs."""

    def open(
        self, target: str, kind: Kind, *, begin_s: float, end_s: float, period_s: float, delay_s: float, seed: int
    ) -> FaultRig:
        """Return a rig in which `target` has a fault from `begin_s` to `end_s`.

        A target that is no part of robot or bus is left to the caller.
        """
        ...
