"""Result of a search for the nearest RLA."""

from typing import NamedTuple

from kurt2rt.core.rla.rla import Rla


class Match(NamedTuple):
    """Nearest RLA of a situation, and the runner-up."""

    rla: Rla
    """Nearest RLA, also if the situation lies outside its radius."""
    distance: float
    radius: float
    runner_up: Rla | None
    runner_up_distance: float
    """Infinite without a runner-up."""

    @property
    def known(self) -> bool:
        """Return whether the situation lies inside the nearest RLA's confidence radius, and that RLA has an action."""
        return self.distance <= self.radius and not self.rla.is_withdrawn
