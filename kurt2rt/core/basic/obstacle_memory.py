"""Memory of the obstacles that the infra-red sensors saw in the last seconds of driving, and contact with them."""

import math
from collections.abc import Mapping
from functools import lru_cache
from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from config.settings import Settings
from hal.numerics import cos_sin, round_portable
from hal.odometry import PlanePose, WheelOdometry
from hal.robot import HIGHEST_COUNTS, SensorReadings, WheelSpeeds
from hal.robot_settings import InfraredSettings, RobotSettings, SensorSettings

_STEP_S = 0.1
"""Time between two poses of the outline that are compared with the obstacles: 3 cm at 0.3 m/s."""

_NOWHERE_M = 1e6
"""Place of a reading without an obstacle: no outline gets there."""

Values = NDArray[np.float64]


class ContactSettings(Settings):
    """Memory of obstacles, and the actions that run into them."""

    memory_s: Annotated[float, Field(ge=0.1, le=10)]
    """Time of driving for which an obstacle is remembered; a robot that stands forgets nothing."""
    within_s: Annotated[float, Field(ge=_STEP_S, le=1)]
    """An action runs into an obstacle if its outline meets the obstacle within this time."""
    farthest_m: Annotated[float, Field(gt=0, le=1)]
    """Distance from a sensor up to which a reading is an obstacle."""
    margin_m: Annotated[float, Field(ge=0, le=0.1)]
    """Distance from the outline at which an obstacle is met."""
    look_s: Annotated[float, Field(ge=0.05, le=0.2)]
    """Time between two looks."""


class Contact(NamedTuple):
    """Remembered obstacle that the robot's outline would meet if an action drove on."""

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


class _Sweep(NamedTuple):
    """Poses of an action for some steps, and the box around the outline at all of them."""

    motion: _Motion
    middle_m: Values
    """Middle of the box, ahead and aside, shape (2, 1)."""
    half_m: Values
    """Half length and half width of the box, shape (2, 1)."""


class ObstacleMemory:
    """Obstacles seen in the last seconds of driving, and the actions that would meet them (local map).

    Places in m come from readings and wheel odometry; `DoubtMeter` asks it for each action.

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
        steps = round(settings.within_s / _STEP_S)
        self._sweeps = {
            name: self._sweep(_motion(speeds, steps, geometry.effective_track_m)) for name, speeds in actions.items()
        }
        self._seen_m = np.concatenate([_seen_m(law, sensor, settings.farthest_m) for sensor in law.sensors], axis=1)
        """Place of what each sensor sees at each count, ahead and aside, shape (2, sensors * counts)."""
        self._sensors = len(law.sensors)
        self._first = np.arange(self._sensors) * (HIGHEST_COUNTS + 1)
        self._look_s = settings.look_s
        self._look_ticks = max(1, round(settings.look_s / robot.cycle_s))
        self._looks = max(1, round(settings.memory_s / self._look_s))
        # Relative to the robot, and moved with it: each look needs the places so.
        self._places_m = np.full((2, self._looks * self._sensors), _NOWHERE_M)
        self._products_m = np.zeros((2, *self._places_m.shape))
        self._rotation = np.zeros((2, 2, 1))
        self._shift_m = np.zeros((2, 1))
        self._met: dict[str, bool] = {}
        """Result for each action that was asked since the last look."""
        self.clear()

    def clear(self) -> None:
        """Forget all obstacles, because the robot was set down elsewhere."""
        self._places_m.fill(_NOWHERE_M)
        self._newest = self._ticks = self._left_ticks = self._right_ticks = 0
        self._met.clear()

    def update(self, readings: SensorReadings) -> None:
        """Count the way of one tick, and look at the sensors every `look_s`; call it once a tick."""
        self._left_ticks += readings.encoder_left_ticks
        self._right_ticks += readings.encoder_right_ticks
        self._ticks += 1
        if self._ticks == self._look_ticks:
            self._ticks = 0
            if self._left_ticks or self._right_ticks:
                self._move()
            self._look(readings.infrared_counts)

    def meets(self, action: str) -> bool:
        """Return whether an action meets an obstacle within `within_s`; False if it has no set points."""
        met = self._met.get(action)
        if met is None:
            sweep = self._sweeps.get(action)
            met = self._met[action] = sweep is not None and self._is_met(sweep)
        return met

    def remembers_within(self, distance_m: float) -> bool:
        """Return whether an obstacle is remembered inside the outline or this close to it."""
        ahead_m, aside_m = np.abs(self._places_m)
        inside = (ahead_m < self._half_length_m + distance_m) & (aside_m < self._half_width_m + distance_m)
        return bool(inside.any())

    def contact(self, action: str) -> Contact | None:
        """Return the first obstacle that an action meets; None if it meets none in time."""
        sweep = self._sweeps.get(action)
        if sweep is None:
            return None
        near = self._in_box(sweep)
        steps, obstacles = np.nonzero(self._met_by(sweep.motion, near))
        if not len(steps):
            return None
        look, sensor = divmod(int(near[obstacles[0]]), self._sensors)
        age = (self._newest - look) % self._looks
        return Contact((int(steps[0]) + 1) * _STEP_S, sensor, age * self._look_s)

    def _move(self) -> None:
        """Move the remembered places by the encoders, and make room for the next look."""
        motion = self._odometry.motion(self._left_ticks, self._right_ticks)
        self._left_ticks = self._right_ticks = 0
        middle_rad = motion.turn_rad / 2
        shift_m, rotation, places_m, products_m = self._shift_m, self._rotation, self._places_m, self._products_m
        shift_m[0, 0] = motion.forward_m * round_portable(math.cos(middle_rad))
        shift_m[1, 0] = motion.forward_m * round_portable(math.sin(middle_rad))
        cos, sin = round_portable(math.cos(motion.turn_rad)), round_portable(math.sin(motion.turn_rad))
        rotation[0, 0, 0] = rotation[1, 1, 0] = cos
        rotation[0, 1, 0], rotation[1, 0, 0] = sin, -sin
        np.subtract(places_m, shift_m, out=places_m)
        # Products and sums one by one: a matrix product rounds otherwise on another processor.
        np.multiply(rotation, places_m, out=products_m)
        np.add(products_m[:, 0], products_m[:, 1], out=places_m)
        self._newest = (self._newest + 1) % self._looks

    def _look(self, counts: tuple[int, ...]) -> None:
        """Store what the sensors see."""
        begin = self._newest * self._sensors
        self._places_m[:, begin : begin + self._sensors] = self._seen_m.take(self._first + counts, axis=1)
        self._met.clear()

    def _is_met(self, sweep: _Sweep) -> bool:
        near = self._in_box(sweep)
        return bool(len(near)) and bool(self._met_by(sweep.motion, near).any())

    def _in_box(self, sweep: _Sweep) -> NDArray[np.intp]:
        """Return the indexes of the remembered places in the box around a sweep."""
        inside = np.abs(self._places_m - sweep.middle_m) < sweep.half_m
        return np.flatnonzero(inside[0] & inside[1])

    def _met_by(self, motion: _Motion, near: NDArray[np.intp]) -> NDArray[np.bool_]:
        """Return whether the outline meets each of these places (n,) at each step; shape (steps, n).

        An obstacle inside the outline is a wrong reading, or it is touched already: no action would be free of it.
        """
        ahead_m, aside_m = self._places_m[:, near]
        x, y = ahead_m - motion.x_m, aside_m - motion.y_m
        ahead, aside = motion.cos * x + motion.sin * y, motion.cos * y - motion.sin * x
        met: NDArray[np.bool_] = self._in_outline(ahead, aside) & ~self._in_outline(ahead_m, aside_m)
        return met

    def _in_outline(self, ahead_m: Values, aside_m: Values) -> NDArray[np.bool_]:
        inside: NDArray[np.bool_] = (np.abs(ahead_m) < self._half_length_m) & (np.abs(aside_m) < self._half_width_m)
        return inside

    def _sweep(self, poses: _Motion) -> _Sweep:
        """Return the poses of a motion with the box around the outline at all of them."""
        reach_x_m = np.abs(poses.cos) * self._half_length_m + np.abs(poses.sin) * self._half_width_m
        reach_y_m = np.abs(poses.sin) * self._half_length_m + np.abs(poses.cos) * self._half_width_m
        highest = np.array([(poses.x_m + reach_x_m).max(), (poses.y_m + reach_y_m).max()])[:, np.newaxis]
        lowest = np.array([(poses.x_m - reach_x_m).min(), (poses.y_m - reach_y_m).min()])[:, np.newaxis]
        # A hair wider, so that rounding leaves nothing out.
        return _Sweep(poses, (highest + lowest) / 2, (highest - lowest) / 2 + 1e-6)


@lru_cache(maxsize=64)
def _seen_m(law: InfraredSettings, sensor: SensorSettings, farthest_m: float) -> Values:
    """Return the place of what a sensor sees at each count, ahead and aside in m, shape (2, counts).

    `farthest_m`: distance beyond which a reading is no obstacle. Do not change the result: all robots share it.
    """
    heading_rad = math.radians(sensor.heading_deg)
    distance_m = np.array([law.distance_m(counts) for counts in range(HIGHEST_COUNTS + 1)])
    ahead_m = sensor.x_m + round_portable(math.cos(heading_rad)) * distance_m
    aside_m = sensor.y_m + round_portable(math.sin(heading_rad)) * distance_m
    return np.where(distance_m <= farthest_m, [ahead_m, aside_m], _NOWHERE_M)


def _motion(speeds: WheelSpeeds, steps: int, track_m: float) -> _Motion:
    """Return the poses at these wheel speeds, `steps` of them; `track_m`: effective distance of the wheels."""
    forward_m = (speeds.left_m_s + speeds.right_m_s) / 2 * _STEP_S
    turn_rad = (speeds.right_m_s - speeds.left_m_s) / track_m * _STEP_S
    pose, rows = PlanePose(), []
    for _ in range(steps):
        pose = pose.moved(forward_m, turn_rad)
        rows.append([*cos_sin(pose.heading_rad), *map(round_portable, pose)])
    columns = np.array(rows).T[:, :, np.newaxis]
    return _Motion(columns[0], columns[1], columns[2], columns[3])
