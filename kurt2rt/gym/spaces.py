"""Observation space: the situation's values with their bounds."""

from typing import TypeAlias

import numpy as np
from gymnasium.spaces import Box, Space
from numpy.typing import NDArray

from hal.robot import HIGHEST_COUNTS
from hal.robot_settings import RobotSettings
from kurt2rt.core.perception.definition import SituationDefinition, WheelSpeed

Values: TypeAlias = NDArray[np.float64]


def observation_space(definition: SituationDefinition, robot: RobotSettings, *, averages: bool) -> Space[Values]:
    """Return the float64 space of the recent values in counts, shape (n,), or with their averages, shape (2 * n,).

    Sensor values lie between 0 and the converter's 1023 counts; a wheel speed between the guard's limits.
    """
    wheel_speed = round(definition.wheel_speed_counts_per_m_s * robot.guard.maximum_speed_m_s)
    bounds = [
        # Gymnasium's checker warns of a value whose bounds are equal, as those of a wheel speed of scale 0 would be.
        (-max(1, wheel_speed), max(1, wheel_speed)) if isinstance(feature, WheelSpeed) else (0, HIGHEST_COUNTS)
        for feature in definition.features
    ]
    low, high = np.array(bounds * (2 if averages else 1), dtype=np.float64).T
    return Box(low, high, dtype=np.float64)
