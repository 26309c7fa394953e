"""What experiments whose results are kept need of a stage besides what each experiment does."""

from typing import TYPE_CHECKING, Protocol

from kurt2rt.experiments.arena import Stage

if TYPE_CHECKING:
    from matplotlib.axes import Axes


class StudyStage(Stage, Protocol):
    """A stage that tells one version of a world from another."""

    def require_worlds(self, *worlds: str) -> None:
        """Look at each world. Raises hal.settings.SettingsError."""
        ...

    def settings_of(self, world: str) -> str:
        """All that a world is made of."""
        ...

    def draw_robot(self, axes: "Axes", world: str) -> None:
        """Draw the robot where a drive in this world may begin."""
        ...
