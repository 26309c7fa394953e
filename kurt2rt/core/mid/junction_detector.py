"""Notices junctions that the robot passes: by its side sensors, and by way driven, never by time."""

import math
from typing import Annotated

from pydantic import Field

from hal.odometry import WheelOdometry
from hal.robot import HIGHEST_COUNTS, SensorReadings
from hal.robot_settings import InfraredSettings, RobotSettings
from hal.settings import Settings, SettingsError
from kurt2rt.core.decision.junction_event import JunctionEvent
from kurt2rt.core.numerics import round_portable

Metres = Annotated[float, Field(gt=0, le=10)]
Sensors = Annotated[tuple[str, ...], Field(min_length=2)]

_QUARTER_RAD = math.pi / 2
_TURNED_BACK_RAD = 1.5 * _QUARTER_RAD


class JunctionDetectorSettings(Settings):
    """What counts as a street, and what as a junction. Distances are those that the sensors see."""

    left: Sensors
    """Sensors that look to the left, from front to back."""
    right: Sensors
    wall_m: Metres
    """A sensor that sees something nearer than this sees the wall of the street."""
    open_sensors: Annotated[int, Field(ge=1, le=18)]
    """A side is open where so many of its sensors see no wall."""
    open_over_m: Metres
    """Over so much way a side must be open for a junction to begin."""
    way_m: Metres
    """A way leads off where so many sensors of a side see nothing nearer than this; farther than `wall_m`, for a robot
    that turns away from a wall sees it farther off, too."""
    parallel_rad: Annotated[float, Field(gt=0, le=1.5)]
    """In a street the walls on both sides are no farther from parallel than this: else the robot is still turning."""
    street_over_m: Metres
    """Over so much way walls must stand on both sides for the robot to be sure that it is in a street again."""
    through_m: Metres
    """A robot that is in the same direction again before it has come so far was in no junction: there was a gap in a
    wall, or it looked in and drove back."""
    heading_over_m: Metres
    """Over so much way its heading between the walls is averaged."""


class JunctionDetector:
    """Follows the robot from street to street, in memory that does not grow; a robot that stands changes nothing.

    Turns are measured between the walls of one street and those of the next: neither how the robot wobbled when it
    left the one, nor how straight it came into the other, counts, only the encoders' drift within one junction.
    """

    def __init__(self, settings: JunctionDetectorSettings, robot: RobotSettings) -> None:
        """Raises SettingsError for a sensor that the robot does not have."""
        infrared = robot.infrared
        missing = sorted({*settings.left, *settings.right} - set(infrared.names))
        if missing:
            raise SettingsError(
                f"junctions: the robot has no sensor {', '.join(missing)}", do=f"allowed: {', '.join(infrared.names)}"
            )
        self._settings = settings
        # Looked up by counts: this runs in every tick.
        self._distance_m = tuple(infrared.distance_m(counts) for counts in range(HIGHEST_COUNTS + 1))
        self._left, self._left_baseline_m = _side(infrared, settings.left)
        self._right, self._right_baseline_m = _side(infrared, settings.right)
        self._odometry = WheelOdometry(robot.geometry)
        self._yaw_rad = 0.0
        self.restart()

    @property
    def yaw_rad(self) -> float:
        """How far the robot has turned to the left since it was switched on, by its encoders."""
        return self._yaw_rad

    @property
    def street_rad(self) -> float | None:
        """How the street runs that it is in, or came from, measured against `yaw_rad`; None before the first."""
        return self._street_rad

    def restart(self) -> None:
        """Forget what was: nobody can say which way the robot came."""
        self.walled = self.opened = False
        """Whether in this tick parallel walls stand on both sides, or a side is open; neither in between."""
        self.turn_rad = self.rims_m = 0.0
        """How far the robot has turned to the left in this tick, and how far its wheels have, the mean of both."""
        self._street_rad: float | None = None
        """How the street runs that it is in, or came from, by the encoders."""
        self._inside = True
        self._left_open = self._right_open = False
        self._open_m = self._between_m = self._between_rad = 0.0
        self._begin_way()

    def _begin_way(self) -> None:
        """From here on the way is one through a junction, if it becomes one."""
        self._way_m = self._net_m = 0.0

    def perceive(self, senses: SensorReadings) -> JunctionEvent | None:
        """Take in one tick; returns the junction that was passed, in the tick in which the robot is sure of it."""
        left_m, right_m, way_m, self.turn_rad = self._odometry.motion(
            senses.encoder_left_ticks, senses.encoder_right_ticks
        )
        step_m = abs(way_m)
        self.rims_m = (abs(left_m) + abs(right_m)) / 2
        self._yaw_rad += self.turn_rad
        self._way_m += step_m
        self._net_m += way_m
        wall_m, distance_m, counts = self._settings.wall_m, self._distance_m, senses.infrared_counts
        left = [distance_m[counts[place]] for place in self._left]
        right = [distance_m[counts[place]] for place in self._right]
        if max(left) < wall_m and max(right) < wall_m:
            return self._pass_walls(left, right, step_m)
        self.walled = False
        self._between_m = 0.0
        self._look_into_sides(left, right, step_m)
        return None

    def _look_into_sides(self, left: list[float], right: list[float], step_m: float) -> None:
        """Somewhere no wall is seen."""
        want = self._settings
        self.opened = (
            sum(each >= want.wall_m for each in left) >= want.open_sensors
            or sum(each >= want.wall_m for each in right) >= want.open_sensors
        )
        if not self.opened:
            if not self._inside:
                self._open_m = 0.0
            return
        self._open_m += step_m
        if self._open_m < want.open_over_m:
            return
        self._inside = True
        # Once it has turned, its sides look elsewhere than along the sides of the street that it came from.
        if self._street_rad is not None and abs(self._yaw_rad - self._street_rad) < want.parallel_rad:
            self._left_open |= sum(each >= want.way_m for each in left) >= want.open_sensors
            self._right_open |= sum(each >= want.way_m for each in right) >= want.open_sensors

    def _pass_walls(self, left: list[float], right: list[float], step_m: float) -> JunctionEvent | None:
        """Walls are seen on both sides, by all sensors."""
        self.opened = False
        self._open_m = 0.0
        want = self._settings
        left_rad = round_portable(math.atan2(left[-1] - left[0], self._left_baseline_m))
        right_rad = round_portable(math.atan2(right[0] - right[-1], self._right_baseline_m))
        self.walled = abs(left_rad) < want.parallel_rad and abs(right_rad) < want.parallel_rad
        if not self.walled:
            self._between_m = 0.0
            return None
        if step_m == 0.0:
            return None
        heading_rad = self._yaw_rad - (left_rad + right_rad) / 2
        if self._street_rad is not None and not self._inside:
            off_rad = heading_rad - self._street_rad
            if abs(off_rad) < _TURNED_BACK_RAD:
                self._street_rad += min(1.0, step_m / want.heading_over_m) * off_rad
                self._begin_way()
                return None
            self._inside = True
        self._between_m += step_m
        self._between_rad += step_m / self._between_m * (heading_rad - self._between_rad)
        return self._arrive() if self._between_m >= want.street_over_m else None

    def _arrive(self) -> JunctionEvent | None:
        """In a street, and sure of it."""
        came_rad, self._street_rad = self._street_rad, self._between_rad
        event = None if came_rad is None else self._passed(self._street_rad - came_rad)
        self._inside = self._left_open = self._right_open = False
        self._between_m = 0.0
        self._begin_way()
        return event

    def _passed(self, turn_rad: float) -> JunctionEvent | None:
        quarters = round(turn_rad / _QUARTER_RAD) % 4
        if quarters == 0 and abs(self._net_m) < self._settings.through_m:
            return None
        # A side that it took was open, though it may have turned there before it saw much of it.
        left_open, right_open = self._left_open or quarters == 1, self._right_open or quarters == 3
        return JunctionEvent(-1 if quarters == 3 else quarters, left_open, right_open, turn_rad, self._way_m)


def _side(infrared: InfraredSettings, names: tuple[str, ...]) -> tuple[tuple[int, ...], float]:
    """Places of a side's sensors, and how far ahead of the last the first one sits."""
    x_m = {sensor.name: sensor.x_m for sensor in infrared.sensors}
    baseline_m = x_m[names[0]] - x_m[names[-1]]
    if baseline_m <= 0:
        raise SettingsError(
            f"junctions: {names[0]} does not sit ahead of {names[-1]}", do="give a side's sensors from front to back"
        )
    return tuple(infrared.names.index(name) for name in names), baseline_m
