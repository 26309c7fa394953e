"""What a drill needs of the place where it happens: a robot in simulated time, with a fault that comes and goes."""

from collections.abc import Callable
from typing import Protocol

from hal.kurt2 import Kurt2
from hal.tap import Tap
from kurt2rt.checks.faults.table import Kind


class SimulatedTime(Protocol):
    """Time that passes when told to, and what is planned in it."""

    def now_s(self) -> float:
        """The present in seconds."""
        ...

    def at(self, time_s: float, act: Callable[[], None]) -> None:
        """Have something done at a moment."""
        ...

    def every(self, period_s: float, first_s: float, act: Callable[[], None]) -> None:
        """Have something done again and again."""
        ...

    def run_until(self, time_s: float) -> None:
        """Let time pass: the world goes on, and so does the second guard."""
        ...


class RigDisturbance(Protocol):
    """What is wrong, from when to when."""

    @property
    def kind(self) -> Kind:
        """In which way."""
        ...

    @property
    def begin_s(self) -> float:
        """From this time on."""
        ...

    @property
    def end_s(self) -> float:
        """Until then."""
        ...

    @property
    def period_s(self) -> float:
        """As CaseSettings has it."""
        ...

    @property
    def delay_s(self) -> float:
        """As CaseSettings has it."""
        ...

    def acts(self, now_s: float) -> bool:
        """Whether it does harm at this time."""
        ...


class FaultRig(Protocol):
    """Robot, bus and driver."""

    on_sent: Callable[[int, bytes], None]
    """Called with number and payload of each frame that the driver hands to its bus."""
    on_control: Callable[[int, bytes], None]
    """Called for each of them that arrives at the robot's end as CONTROL, with the same number."""

    @property
    def time(self) -> SimulatedTime:
        """The time of all of it."""
        ...

    @property
    def disturbance(self) -> RigDisturbance:
        """The fault."""
        ...

    @property
    def robot(self) -> Kurt2:
        """The driver that is there now."""
        ...

    def restart_driver(self) -> Kurt2:
        """A driver that knows nothing takes the place of the one that was there."""
        ...

    def attach_tap(self, tap: Tap) -> None:
        """Somebody looks on at the driver's end of the bus."""
        ...

    def close(self) -> None:
        """Give the bus back."""
        ...


class RigFactory(Protocol):
    """Opens rigs."""

    def open(
        self, target: str, kind: Kind, *, begin_s: float, end_s: float, period_s: float, delay_s: float, seed: int
    ) -> FaultRig:
        """The place where `target` is disturbed; one that is no part of robot or bus is left to the caller."""
        ...
