"""What an RLA system answers to a situation."""

from typing import NamedTuple

from kurt2rt.core.rla.rla import Rla


class Match(NamedTuple):
    """Answer of an RLA system to a situation."""

    rla: Rla
    """The nearest RLA, also when the situation lies outside its radius."""
    distance: float
    radius: float
    runner_up: Rla | None
    runner_up_distance: float
    """Infinite where there is no runner-up."""

    @property
    def known(self) -> bool:
        """Whether the situation lies within the nearest RLA's confidence radius, and that one has an action."""
        return self.distance <= self.radius and not self.rla.is_withdrawn
