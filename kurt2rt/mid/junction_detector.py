"""Notices junctions that the robot passes: by its side sensors, and by way driven, never by time."""

import math
from typing import Annotated

from pydantic import Field

from hal.robot import HIGHEST_COUNTS, Senses
from hal.robot_settings import RobotSettings
from hal.settings import Settings, SettingsError
from kurt2rt.mid.junction_event import JunctionEvent

Metres = Annotated[float, Field(gt=0, le=10)]
Sensors = Annotated[tuple[str, ...], Field(min_length=2)]

_QUARTER_RAD = math.pi / 2


class JunctionDetectorSettings(Settings):
    """What counts as a street, and what as a junction."""

    left: Sensors
    """Sensors that look to the left, from front to back."""
    right: Sensors
    wall_m: Metres
    """A wall stands beside the robot where all sensors of that side see it nearer than this."""
    open_m: Metres
    """A side is open where none of its sensors sees anything nearer than this."""
    steady_m: Metres
    """Over so much way walls must stand on both sides until the robot is sure to be in a street."""


class JunctionDetector:
    """Follows the robot from street to street. Its memory does not grow, and a robot that stands changes nothing."""

    def __init__(self, settings: JunctionDetectorSettings, robot: RobotSettings) -> None:
        """Raises SettingsError for a sensor that the robot does not have."""
        infrared = robot.infrared
        missing = sorted({*settings.left, *settings.right} - set(infrared.names))
        if missing:
            raise SettingsError(
                f"junctions: the robot has no sensor {', '.join(missing)}; allowed: {', '.join(infrared.names)}"
            )
        self._distance_m = tuple(infrared.distance_m(counts) for counts in range(HIGHEST_COUNTS + 1))
        self._left = tuple(infrared.names.index(name) for name in settings.left)
        self._right = tuple(infrared.names.index(name) for name in settings.right)
        self._wall_m = settings.wall_m
        self._open_m = settings.open_m
        self._steady_m = settings.steady_m
        self._metres_per_tick = robot.geometry.metres_per_tick
        self._track_m = robot.geometry.effective_track_m
        self.restart()

    def restart(self) -> None:
        """Forget what was: where the robot is now there is no way that it came."""
        self._came_from_a_street = False
        self._inside = True
        self._left_open = self._right_open = False
        self._turn_rad = self._way_m = self._walled_m = 0.0

    def perceive(self, senses: Senses) -> JunctionEvent | None:
        """Take in one tick; the junction that has been passed, in the tick in which the robot is sure of it."""
        left_m = senses.encoder_left_ticks * self._metres_per_tick
        right_m = senses.encoder_right_ticks * self._metres_per_tick
        step_m = abs(left_m + right_m) / 2
        self._turn_rad += (right_m - left_m) / self._track_m
        self._way_m += step_m
        distance_m, counts = self._distance_m, senses.infrared_counts
        left = [distance_m[counts[place]] for place in self._left]
        right = [distance_m[counts[place]] for place in self._right]
        if max(left) < self._wall_m and max(right) < self._wall_m:
            if not self._inside:
                self._turn_rad = self._way_m = 0.0
                return None
            self._walled_m += step_m
            if self._walled_m >= self._steady_m:
                return self._arrive()
            return None
        self._walled_m = 0.0
        left_open, right_open = min(left) > self._open_m, min(right) > self._open_m
        if left_open or right_open:
            self._inside = True
            self._left_open |= left_open
            self._right_open |= right_open
        return None

    def _arrive(self) -> JunctionEvent | None:
        """In a street again, and sure of it."""
        quarters = round(self._turn_rad / _QUARTER_RAD) % 4
        event = None
        if self._came_from_a_street:
            turned = -1 if quarters == 3 else quarters
            event = JunctionEvent(turned, self._left_open, self._right_open, self._turn_rad, self._way_m)
        self._came_from_a_street = True
        self._inside = self._left_open = self._right_open = False
        self._turn_rad = self._way_m = self._walled_m = 0.0
        return event
