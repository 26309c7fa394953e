"""Link between the electronics of a simulated robot and the runtime's driver."""

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from typing import Protocol


class SimulatedLink(Protocol):
    """Both ends of a link, and the course of a simulated cycle on it."""

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
    """Link without a time of its own (SimulatedLink)."""

    def cycle(self, step_robot: Callable[[], None]) -> None:
        """Step the robot."""
        step_robot()

    def live(self) -> AbstractContextManager[None]:
        """Return an empty context."""
        return nullcontext()

    def close(self) -> None:
        """Close nothing: this link is in memory."""
