"""Bus between robot and notebook in a simulation: instantaneous, or over a simulated wire."""

import time
import uuid
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from typing import Protocol

from hal.bus import CONTROL_ID, CanBus, open_bus
from hal.robot_kind import NO_WIRE
from hal.settings import SettingsError
from simbridge.simulated_link import SimulatedLink
from simbridge.wire.settings import WireSettings, load_wire
from simbridge.wire.wire import Wire
from simbridge.wire.wire_interface import WireInterface

_KERNEL_DELIVERY_S = 0.001
"""Pause in which the kernel's own thread delivers the frames of a cycle."""


class Line(SimulatedLink, Protocol):
    """Both ends of the bus, and the course of a simulated cycle on it."""

    robot_end: CanBus
    notebook_end: CanBus


class DirectLine:
    """Line without a wire."""

    def __init__(self, bus: str | None = None) -> None:
        """Open both ends of a bus (hal.bus.open_bus) that others may listen to; None: of a channel of their own.

        Raises BusError.
        """
        # A unique channel: two lines in one process must not share frames.
        spec = bus or f"virtual:{uuid.uuid4()}"
        self.robot_end, self.notebook_end = open_bus(spec), open_bus(spec)
        if bus is not None:
            self.robot_end.set_id_filter({CONTROL_ID})  # frames of others must not cost the robot its cycle
        self._delivery_s = 0.0 if ":" in spec else _KERNEL_DELIVERY_S

    def cycle(self, step_robot: Callable[[], None]) -> None:
        """Step the robot."""
        step_robot()
        if self._delivery_s:
            time.sleep(self._delivery_s)

    def live(self) -> AbstractContextManager[None]:
        """Return an empty context: this line has no time."""
        return nullcontext()

    def close(self) -> None:
        """Shut the robot's end."""
        self.robot_end.shutdown()


class WiredLine:
    """Line over a wire with one controller at the robot and one at the notebook.

    In a cycle the notebook's frames travel until the robot's cycle begins. The robot steps, and its frames travel for
    `notebook_phase_s` until the notebook's tick.
    """

    def __init__(self, settings: WireSettings, cycle_s: float, seed: int) -> None:
        """Open a wire. Raises SettingsError if the notebook's tick is not within the robot's cycle."""
        if not settings.notebook_phase_s < cycle_s:
            raise SettingsError(
                f"wire {settings.name}: notebook_phase_s is {settings.notebook_phase_s}, "
                f"allowed is less than the robot's cycle ({cycle_s})"
            )
        self.wire = Wire(settings, seed)
        self.robot_end = CanBus(f"wire:{settings.name}", lambda _: WireInterface(self.wire, settings.robot))
        self.notebook_end = CanBus(f"wire:{settings.name}", lambda _: WireInterface(self.wire, settings.notebook))
        self.robot_end.set_id_filter({CONTROL_ID})  # the robot reads nothing else
        self._cycle_s = cycle_s
        self._phase_s = settings.notebook_phase_s
        self._cycles = 0

    def cycle(self, step_robot: Callable[[], None]) -> None:
        """Carry the notebook's frames, step the robot, carry its frames."""
        self._cycles += 1
        begins_s = self._cycles * self._cycle_s
        self.wire.advance(begins_s)
        step_robot()
        self.wire.advance(begins_s + self._phase_s)

    @contextmanager
    def live(self) -> Iterator[None]:
        """Let the wire follow the monotonic clock within the context."""
        self.wire.follow(time.monotonic)
        try:
            yield
        finally:
            self.wire.follow(None)

    def close(self) -> None:
        """Shut the robot's end."""
        self.robot_end.shutdown()


def open_line(wire: str, cycle_s: float, seed: int, bus: str | None = None) -> Line:
    """Return a line over a wire given by name in config/wires or by path, or `none`. Raises BusError, SettingsError.

    `cycle_s`: duration of a simulated cycle in s. `seed`: of noise and losses. `bus`: that carries a line without a
    wire; None: one of its own.
    """
    if wire == NO_WIRE:
        return DirectLine(bus)
    return WiredLine(load_wire(wire), cycle_s, seed)


def require_wire(wire: str) -> None:
    """Check a wire's settings without opening it. Raises SettingsError."""
    if wire != NO_WIRE:
        load_wire(wire)
