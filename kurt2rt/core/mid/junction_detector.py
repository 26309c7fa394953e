"""Detector of passed junctions, by side sensors and driven distance, never by time."""

import math
from typing import Annotated

from pydantic import Field

from config.settings import Settings, SettingsError
from hal.numerics import round_portable
from hal.odometry import WheelOdometry
from hal.robot import HIGHEST_COUNTS, SensorReadings
from hal.robot_settings import InfraredSettings, RobotSettings
from kurt2rt.core.decision.decision import JunctionEvent
from kurt2rt.core.settings_fields import Metres

Sensors = Annotated[tuple[str, ...], Field(min_length=2)]

_QUARTER_RAD = math.pi / 2
_TURNED_BACK_RAD = 1.5 * _QUARTER_RAD


class JunctionDetectorSettings(Settings):
    """Thresholds by which the mid level detects junctions; distances are sensor readings or driven ones."""

    left: Sensors
    """Left sensors from front to back."""
    right: Sensors
    """Right sensors from front to back."""
    wall_m: Metres
    """Greatest distance of the street's wall."""
    open_sensors: Annotated[int, Field(ge=1, le=18)]
    """Number of sensors without a wall that make a side open."""
    open_over_m: Metres
    """Driven distance with an open side that begins a junction."""
    way_m: Metres
    """Free distance of a side street; above `wall_m`, because a turning robot measures longer distances to a wall."""
    parallel_rad: Annotated[float, Field(gt=0, le=1.5)]
    """Greatest angle to both walls in a street; beyond it the robot is still turning."""
    street_over_m: Metres
    """Driven distance between two walls that ends a junction."""
    through_m: Metres
    """Least distance of a junction passed straight on: less is a gap in a wall, or a drive in and back."""
    heading_over_m: Metres
    """Driven distance over which the heading in a street is averaged."""


class JunctionDetector:
    """Detector of junctions between streets, in constant memory; standstill changes nothing.

    Turns are measured from the walls of one street to those of the next, so only the encoders' drift within one
    junction counts.
    """

    def __init__(self, settings: JunctionDetectorSettings, robot: RobotSettings) -> None:
        """Prepare tables for a robot. Raises SettingsError for an unknown sensor."""
        infrared = robot.infrared
        missing = sorted({*settings.left, *settings.right} - set(infrared.names))
        if missing:
            raise SettingsError(
                f"junctions: the robot has no sensor {', '.join(missing)}", do=f"allowed: {', '.join(infrared.names)}"
            )
        self._settings = settings
        # Distance by count, for a lookup in each tick.
        self._distance_m = tuple(infrared.distance_m(counts) for counts in range(HIGHEST_COUNTS + 1))
        self._left, self._left_baseline_m = _side(infrared, settings.left)
        self._right, self._right_baseline_m = _side(infrared, settings.right)
        self._odometry = WheelOdometry(robot.geometry)
        self.yaw_rad = 0.0
        """Total left turn since power-on, by the encoders."""
        self.restart()

    def restart(self) -> None:
        """Forget the street and the junction."""
        self.turn_rad = 0.0
        """Left turn of this tick."""
        self.street_rad: float | None = None
        """Direction of the present or last street in the frame of `yaw_rad`; None before the first street."""
        self._inside = True
        self._left_open = self._right_open = False
        self._open_m = self._between_m = self._between_rad = 0.0
        self._restart_distance()

    def _restart_distance(self) -> None:
        """Start the distance of a possible junction."""
        self._way_m = self._net_m = 0.0

    def perceive(self, readings: SensorReadings) -> JunctionEvent | None:
        """Process one tick; return the passed junction in the tick that detects the next street.

        Returns None in all other ticks. Call it once per tick, because it sums up the encoders.
        """
        motion = self._odometry.motion(readings.encoder_left_ticks, readings.encoder_right_ticks)
        step_m, self.turn_rad = abs(motion.forward_m), motion.turn_rad
        self.yaw_rad += motion.turn_rad
        self._way_m += step_m
        self._net_m += motion.forward_m
        wall_m, distance_m, counts = self._settings.wall_m, self._distance_m, readings.infrared_counts
        left = [distance_m[counts[place]] for place in self._left]
        right = [distance_m[counts[place]] for place in self._right]
        if max(left) < wall_m and max(right) < wall_m:
            return self._update_walls(left, right, step_m)
        self._between_m = 0.0
        self._update_open_sides(left, right, step_m)
        return None

    def _update_open_sides(self, left: list[float], right: list[float], step_m: float) -> None:
        """Process a tick without walls on all sensors; distances in m."""
        want = self._settings
        opened = (
            sum(each >= want.wall_m for each in left) >= want.open_sensors
            or sum(each >= want.wall_m for each in right) >= want.open_sensors
        )
        if not opened:
            if not self._inside:
                self._open_m = 0.0
            return
        self._open_m += step_m
        if self._open_m < want.open_over_m:
            return
        self._inside = True
        # After a turn the side sensors do not point to the sides of the old street.
        if self.street_rad is not None and abs(self.yaw_rad - self.street_rad) < want.parallel_rad:
            self._left_open |= sum(each >= want.way_m for each in left) >= want.open_sensors
            self._right_open |= sum(each >= want.way_m for each in right) >= want.open_sensors

    def _update_walls(self, left: list[float], right: list[float], step_m: float) -> JunctionEvent | None:
        """Process a tick with walls on all sensors; distances in m."""
        self._open_m = 0.0
        want = self._settings
        left_rad = round_portable(math.atan2(left[-1] - left[0], self._left_baseline_m))
        right_rad = round_portable(math.atan2(right[0] - right[-1], self._right_baseline_m))
        if abs(left_rad) >= want.parallel_rad or abs(right_rad) >= want.parallel_rad:
            self._between_m = 0.0
            return None
        if step_m == 0.0:
            return None
        heading_rad = self.yaw_rad - (left_rad + right_rad) / 2
        if self.street_rad is not None and not self._inside:
            off_rad = heading_rad - self.street_rad
            if abs(off_rad) < _TURNED_BACK_RAD:
                self.street_rad += min(1.0, step_m / want.heading_over_m) * off_rad
                self._restart_distance()
                return None
            self._inside = True
        self._between_m += step_m
        self._between_rad += step_m / self._between_m * (heading_rad - self._between_rad)
        return self._enter_street() if self._between_m >= want.street_over_m else None

    def _enter_street(self) -> JunctionEvent | None:
        """Enter a street; return the passed junction, None for the first street or a gap."""
        came_rad, self.street_rad = self.street_rad, self._between_rad
        event = None if came_rad is None else self._make_event(self.street_rad - came_rad)
        self._inside = self._left_open = self._right_open = False
        self._between_m = 0.0
        self._restart_distance()
        return event

    def _make_event(self, turn_rad: float) -> JunctionEvent | None:
        quarters = round(turn_rad / _QUARTER_RAD) % 4
        if quarters == 0 and abs(self._net_m) < self._settings.through_m:
            return None
        # The side that it turned to was open, even if it turned before measuring it.
        left_open, right_open = self._left_open or quarters == 1, self._right_open or quarters == 3
        return JunctionEvent(-1 if quarters == 3 else quarters, left_open, right_open, turn_rad, self._way_m)


def _side(infrared: InfraredSettings, names: tuple[str, ...]) -> tuple[tuple[int, ...], float]:
    """Return the indexes of a side's sensors, and the distance in m from the last one forward to the first."""
    x_m = {sensor.name: sensor.x_m for sensor in infrared.sensors}
    baseline_m = x_m[names[0]] - x_m[names[-1]]
    if baseline_m <= 0:
        raise SettingsError(
            f"junctions: {names[0]} does not sit ahead of {names[-1]}", do="give a side's sensors from front to back"
        )
    return tuple(infrared.names.index(name) for name in names), baseline_m
