"""Worlds of a robot's simulations: checked, described and drawn."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from hal.robot_settings import RobotSettings
from simbridge.contracts.simulation import WorldPlan
from simbridge.simulated_world import plan_of
from simbridge.survey.drawing import draw_robot, draw_world
from simbridge.worlds.world_loading import load_world

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@dataclass(frozen=True, slots=True)
class RobotWorlds:
    """Base of factories of simulations: checks, plans and draws a robot's worlds; subclasses add `open` and `live`."""

    settings: RobotSettings

    def require_worlds(self, *worlds: str) -> None:
        """Check each world, so that a long job does not fail at its last one. Raises SettingsError."""
        for world in worlds:
            load_world(world, self.settings)

    def plan_of(self, world: str) -> WorldPlan:
        """Return a world from above. Raises config.settings.SettingsError for an unknown world."""
        return plan_of(load_world(world, self.settings))

    def draw(self, axes: "Axes", world: str) -> None:
        """Draw a world from above on axes in m. Raises config.settings.SettingsError for an unknown world."""
        draw_world(axes, load_world(world, self.settings))

    def draw_robot(self, axes: "Axes", world: str) -> None:
        """Draw the robot at the first start pose of a world, on axes in m.

        Raises config.settings.SettingsError for an unknown world.
        """
        draw_robot(axes, load_world(world, self.settings).start_poses[0].pose, self.settings)

    def settings_of(self, world: str) -> str:
        """Return all settings of a world as a text. Raises config.settings.SettingsError for an unknown world."""
        return load_world(world, self.settings).model_dump_json(serialize_as_any=True)
