"""The bus between robot and notebook in a simulation: without a wire, or over one with a time of its own."""

import time
import uuid
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from typing import Protocol

from hal.bus import CONTROL_ID, CanBus, open_bus
from hal.settings import SettingsError
from simbridge.wire.end import WireInterface
from simbridge.wire.settings import WireSettings, load_wire
from simbridge.wire.wire import Wire

NO_WIRE = "none"
"""Name of the line without a wire: frames are there as soon as they are sent."""


class Line(Protocol):
    """Both ends of the bus, and how a cycle of simulated time goes over it."""

    robot_end: CanBus
    notebook_end: CanBus

    def cycle(self, step_robot: Callable[[], None]) -> None:
        """Let one cycle of simulated time pass, to the moment of the notebook's tick."""
        ...

    def live(self) -> AbstractContextManager[None]:
        """Time goes on by itself as the wall clock does, until the context ends."""
        ...


class DirectLine:
    """No wire: what is sent is there."""

    def __init__(self) -> None:
        # Two lines in one process must not hear each other.
        spec = f"virtual:{uuid.uuid4()}"
        self.robot_end, self.notebook_end = open_bus(spec), open_bus(spec)

    def cycle(self, step_robot: Callable[[], None]) -> None:
        """The robot's cycle."""
        step_robot()

    def live(self) -> AbstractContextManager[None]:
        """Nothing here has a time."""
        return nullcontext()


class WiredLine:
    """A wire with one controller at the robot and one at the notebook.

    A cycle goes: what the notebook sent travels until the robot's cycle begins, the robot takes its step, and its
    frames travel until the notebook's tick, `notebook_phase_s` later.
    """

    def __init__(self, settings: WireSettings, cycle_s: float, seed: int) -> None:
        """Raises SettingsError when the notebook's tick is not within the robot's cycle."""
        if not settings.notebook_phase_s < cycle_s:
            raise SettingsError(
                f"wire {settings.name}: notebook_phase_s is {settings.notebook_phase_s}, "
                f"allowed is less than the robot's cycle ({cycle_s})"
            )
        self.wire = Wire(settings, seed)
        self.robot_end = CanBus(f"wire:{settings.name}", lambda _: WireInterface(self.wire, settings.robot))
        self.notebook_end = CanBus(f"wire:{settings.name}", lambda _: WireInterface(self.wire, settings.notebook))
        self.robot_end.set_id_filter({CONTROL_ID})  # all that the robot reads; its own frames need not come back
        self._cycle_s = cycle_s
        self._phase_s = settings.notebook_phase_s
        self._cycles = 0

    def cycle(self, step_robot: Callable[[], None]) -> None:
        """What is on its way to the robot, the robot's cycle, what is on its way to the notebook."""
        self._cycles += 1
        begins_s = self._cycles * self._cycle_s
        self.wire.advance(begins_s)
        step_robot()
        self.wire.advance(begins_s + self._phase_s)

    @contextmanager
    def live(self) -> Iterator[None]:
        """The wire follows the machine's monotonic clock."""
        self.wire.follow(time.monotonic)
        try:
            yield
        finally:
            self.wire.follow(None)


def open_line(wire: str, cycle_s: float, seed: int) -> Line:
    """A line over a wire by its name in config/wires or the path of its file, or `none`. Raises SettingsError."""
    if wire == NO_WIRE:
        return DirectLine()
    return WiredLine(load_wire(wire), cycle_s, seed)


def require_wire(wire: str) -> None:
    """Look at a wire's settings without opening it. Raises SettingsError."""
    if wire != NO_WIRE:
        load_wire(wire)
