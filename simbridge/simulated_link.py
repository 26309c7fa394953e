"""Link between the electronics of a simulated robot and the runtime's driver."""

import time
import uuid
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from typing import Protocol

from hal.bus import CONTROL_ID, open_bus


class SimulatedLink(Protocol):
    """Link between a simulated robot and its driver, which decides what a simulated cycle does on it."""

    def cycle(self, step_robot: Callable[[], None]) -> None:
        """Simulate one cycle up to the runtime's tick; `step_robot` is called once within it."""
        ...

    def live(self) -> AbstractContextManager[None]:
        """Return a context in which the link follows the wall clock."""
        ...

    def close(self) -> None:
        """Close the robot's end, after the driver closed its own."""
        ...


class InstantLink:
    """Base of links in memory, over which reports arrive in the cycle that made them (SimulatedLink)."""

    def cycle(self, step_robot: Callable[[], None]) -> None:
        """Step the robot; its reports arrive at once."""
        step_robot()

    def live(self) -> AbstractContextManager[None]:
        """Return an empty context, because nothing runs in real time."""
        return nullcontext()

    def close(self) -> None:
        """Close nothing: this link is in memory."""


_KERNEL_DELIVERY_S = 0.001
"""Pause in which the kernel's own thread delivers the frames of a cycle."""


class CanLine(InstantLink):
    """Both ends of a CAN bus between a simulated KURT2 and its driver; frames take no simulated time."""

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
        """Step the robot, then wait until the bus has delivered its frames."""
        step_robot()
        if self._delivery_s:
            time.sleep(self._delivery_s)

    def close(self) -> None:
        """Shut the robot's end of the bus down."""
        self.robot_end.shutdown()
