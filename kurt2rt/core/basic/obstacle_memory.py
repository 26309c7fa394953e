"""Memory of the obstacles that the infra-red sensors saw in the last seconds of driving, and contact with them."""

import math
from collections.abc import Mapping
from typing import Annotated, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from hal.odometry import PlanePose, WheelOdometry
from hal.robot import HIGHEST_COUNTS, SensorReadings, WheelSpeeds
from hal.robot_settings import RobotSettings
from hal.settings import Settings
from kurt2rt.core.numerics import round_portable

LOOK_TICKS = 5
"""Ticks between two looks: each look meets new measurements, because a sensor measures every 29 to 48 ms."""

_STEP_S = 0.1
"""Time between two poses of the outline that are compared with the obstacles: 3 cm at 0.3 m/s."""

_FASTEST_M_S = 0.6
"""The guard's highest speed, for the distance within which obstacles can be met."""

Values = NDArray[np.float64]


class ContactSettings(Settings):
    """Memory of obstacles, and the actions that run into them."""

    memory_s: Annotated[float, Field(ge=0.1, le=10)]
    """Time of driving for which an obstacle is remembered; a robot that stands forgets nothing."""
    within_s: Annotated[float, Field(ge=_STEP_S, le=1)]
    """An action runs into an obstacle if its outline meets the obstacle within this time."""
    free_s: Annotated[float, Field(ge=_STEP_S, le=2)]
    """An action is free of obstacles, for a robot that avoids one, if it meets none within this time."""
    farthest_m: Annotated[float, Field(gt=0, le=1)]
    """Distance from a sensor up to which a reading is an obstacle."""
    margin_m: Annotated[float, Field(ge=0, le=0.1)]
    """Distance from the outline at which an obstacle is met."""
    avoids: bool = False
    """Drive by the nearest RLA whose action meets no obstacle, except while the robot is taught; False only tells."""

    @model_validator(mode="after")
    def _is_free_for_longer(self) -> Self:
        if self.free_s < self.within_s:
            raise ValueError(f"free_s must be at least within_s ({self.within_s:g})")
        return self


class Contact(NamedTuple):
    """Remembered obstacle that an action would meet."""

    within_s: float
    """Time until the outline meets the obstacle, in steps of 0.1 s."""
    sensor: int
    """Index of the sensor that saw the obstacle, in the order of SensorReadings.infrared_counts."""
    seen_s: float
    """Age of that look, in s of driving."""


class _Motion(NamedTuple):
    """Poses of the outline while an action drives, relative to the present pose; each array has shape (steps, 1)."""

    cos: Values
    sin: Values
    x_m: Values
    y_m: Values


class ObstacleMemory:
    """Obstacles seen in the last seconds, by dead reckoning, and the actions that would meet them.

    A thin post is seen for a moment and then stands between two beams, where no reading tells of it. Deterministic,
    with a fixed amount of state.
    """

    def __init__(self, settings: ContactSettings, robot: RobotSettings, actions: Mapping[str, WheelSpeeds]) -> None:
        """Begin without obstacles.

        Args:
            settings: times and distances.
            robot: outline, sensors and encoders.
            actions: set points of the actions that can be judged, by name.
        """
        geometry, law = robot.geometry, robot.infrared
        self.settings = settings
        self._odometry = WheelOdometry(geometry)
        self._half_length_m = geometry.outline_length_m / 2 + settings.margin_m
        self._half_width_m = geometry.outline_width_m / 2 + settings.margin_m
        reach_m = math.hypot(self._half_length_m, self._half_width_m) + settings.free_s * _FASTEST_M_S
        self._reach_m2 = reach_m * reach_m
        self._motions = {
            name: _motion(speeds, round(settings.free_s / _STEP_S), geometry.effective_track_m)
            for name, speeds in actions.items()
        }
        distances_m = map(law.distance_m, range(HIGHEST_COUNTS + 1))
        # Not a number beyond the farthest distance: it compares as false, so it is never met.
        self._distance_m = np.array([each if each <= settings.farthest_m else math.nan for each in distances_m])
        headings = [math.radians(sensor.heading_deg) for sensor in law.sensors]
        self._sensor_x_m = np.array([sensor.x_m for sensor in law.sensors])
        self._sensor_y_m = np.array([sensor.y_m for sensor in law.sensors])
        self._sensor_cos = np.array([round_portable(math.cos(heading)) for heading in headings])
        self._sensor_sin = np.array([round_portable(math.sin(heading)) for heading in headings])
        self._look_s = LOOK_TICKS * robot.can.cycle_s
        self._looks = max(1, round(settings.memory_s / self._look_s))
        self._x_m = np.full((self._looks, len(headings)), math.nan)
        self._y_m = np.full((self._looks, len(headings)), math.nan)
        self._within, self._free = round(settings.within_s / _STEP_S), round(settings.free_s / _STEP_S)
        self._met: dict[tuple[str, int], bool] = {}
        """Result for each action and number of steps that was asked since the last look."""
        self.clear()

    def clear(self) -> None:
        """Forget all obstacles, because the robot was set down elsewhere."""
        self._x_m.fill(math.nan)
        self._y_m.fill(math.nan)
        self._pose = PlanePose()
        self._newest = self._ticks = self._left_ticks = self._right_ticks = 0
        self._near = np.zeros(0, dtype=np.intp)
        self._ahead_m = self._aside_m = np.zeros(0)
        self._met.clear()

    def update(self, readings: SensorReadings) -> None:
        """Count the way of one tick, and look at the sensors in every fifth tick; call it once a tick."""
        self._left_ticks += readings.encoder_left_ticks
        self._right_ticks += readings.encoder_right_ticks
        self._ticks += 1
        if self._ticks == LOOK_TICKS:
            self._ticks = 0
            if self._left_ticks or self._right_ticks:
                self._move()
            self._look(readings.infrared_counts)

    def meets(self, action: str, *, avoiding: bool = False) -> bool:
        """Return whether an action meets an obstacle within `within_s`; False if it has no set points.

        `avoiding`: within `free_s`, so that a robot that avoids an obstacle does not turn back to it at once.
        """
        steps = self._free if avoiding else self._within
        met = self._met.get((action, steps))
        if met is None:
            motion = self._motions.get(action)
            met = self._met[action, steps] = motion is not None and bool(self._met_by(motion, steps).any())
        return met

    def is_free(self, action: str, *, avoiding: bool) -> bool:
        """Return whether an action has set points and meets no obstacle; `avoiding` as in `meets`."""
        return action in self._motions and not self.meets(action, avoiding=avoiding)

    def contact(self, action: str) -> Contact | None:
        """Return the first obstacle that an action meets; None if it meets none in time."""
        motion = self._motions.get(action)
        if motion is None:
            return None
        steps, obstacles = np.nonzero(self._met_by(motion, self._free))
        if not len(steps):
            return None
        look, sensor = divmod(int(self._near[obstacles[0]]), len(self._sensor_x_m))
        age = (self._newest - look) % self._looks
        return Contact((int(steps[0]) + 1) * _STEP_S, sensor, age * self._look_s)

    def _move(self) -> None:
        """Update the pose by the encoders, and make room for the next look."""
        motion = self._odometry.motion(self._left_ticks, self._right_ticks)
        self._left_ticks = self._right_ticks = 0
        middle_rad = self._pose.heading_rad + motion.turn_rad / 2
        self._pose = PlanePose(
            self._pose.x_m + motion.forward_m * round_portable(math.cos(middle_rad)),
            self._pose.y_m + motion.forward_m * round_portable(math.sin(middle_rad)),
            math.remainder(self._pose.heading_rad + motion.turn_rad, math.tau),
        )
        self._newest = (self._newest + 1) % self._looks

    def _look(self, counts: tuple[int, ...]) -> None:
        """Store what the sensors see, and select the obstacles within reach and outside the outline."""
        x_m, y_m, heading_rad = self._pose
        cos, sin = round_portable(math.cos(heading_rad)), round_portable(math.sin(heading_rad))
        distance_m = self._distance_m[list(counts)]
        ahead = self._sensor_x_m + self._sensor_cos * distance_m
        aside = self._sensor_y_m + self._sensor_sin * distance_m
        self._x_m[self._newest] = x_m + (cos * ahead - sin * aside)
        self._y_m[self._newest] = y_m + (sin * ahead + cos * aside)
        x, y = self._x_m.ravel() - x_m, self._y_m.ravel() - y_m
        near = np.flatnonzero(x * x + y * y < self._reach_m2)
        x, y = x[near], y[near]
        ahead, aside = cos * x + sin * y, cos * y - sin * x
        # An obstacle inside the outline is a wrong reading, or it is touched already: no action would be free of it.
        outside = (np.abs(ahead) >= self._half_length_m) | (np.abs(aside) >= self._half_width_m)
        self._near, self._ahead_m, self._aside_m = near[outside], ahead[outside], aside[outside]
        self._met.clear()

    def _met_by(self, motion: _Motion, steps: int) -> NDArray[np.bool_]:
        """Return whether the outline meets each near obstacle at each step; shape (steps, obstacles)."""
        cos, sin = motion.cos[:steps], motion.sin[:steps]
        x, y = self._ahead_m - motion.x_m[:steps], self._aside_m - motion.y_m[:steps]
        ahead, aside = cos * x + sin * y, cos * y - sin * x
        met: NDArray[np.bool_] = (np.abs(ahead) < self._half_length_m) & (np.abs(aside) < self._half_width_m)
        return met


def _motion(speeds: WheelSpeeds, steps: int, track_m: float) -> _Motion:
    """Return the poses at these wheel speeds, `steps` of them; `track_m`: effective distance of the wheels."""
    forward_m = (speeds.left_m_s + speeds.right_m_s) / 2 * _STEP_S
    turn_rad = (speeds.right_m_s - speeds.left_m_s) / track_m * _STEP_S
    pose, rows = PlanePose(), []
    for _ in range(steps):
        pose = pose.moved(forward_m, turn_rad)
        rows.append([round_portable(each) for each in (math.cos(pose.heading_rad), math.sin(pose.heading_rad), *pose)])
    columns = np.array(rows).T[:, :, np.newaxis]
    return _Motion(columns[0], columns[1], columns[2], columns[3])
