"""Picture of the world from above with the robot in it, as an array."""

from collections.abc import Sequence

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray

from hal.robot_settings import RobotSettings
from hal.simulation import Pose, Position, SimulationFactory
from simbridge.survey.drawing import draw_robot, draw_trail

_SIDE_INCHES, _DOTS_PER_INCH = 6.0, 80


class Picture:
    """Drawing of one world, for the frames of one episode."""

    def __init__(self, factory: SimulationFactory, world: str, robot: RobotSettings) -> None:
        """Draw the walls. Raises hal.settings.SettingsError for an unknown world."""
        self._robot = robot
        figure = Figure(figsize=(_SIDE_INCHES, _SIDE_INCHES), dpi=_DOTS_PER_INCH, layout="constrained")
        self._canvas = FigureCanvasAgg(figure)
        self._axes = figure.subplots()
        factory.draw(self._axes, world)

    def frame(self, pose: Pose, trail: Sequence[Position]) -> NDArray[np.uint8]:
        """Return the world with the robot at a pose and the way that it came, RGB of shape (height, width, 3)."""
        walls = set(self._axes.get_children())
        draw_trail(self._axes, trail)
        draw_robot(self._axes, pose, self._robot)
        self._canvas.draw()  # type: ignore[no-untyped-call]
        pixels = np.array(self._canvas.buffer_rgba(), dtype=np.uint8)[:, :, :3]  # type: ignore[no-untyped-call]
        for drawn in set(self._axes.get_children()) - walls:
            drawn.remove()
        return pixels
