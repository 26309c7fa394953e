"""Mid-level situation as a place: dead-reckoned pose, and the walls of the last junction."""

import math
from collections.abc import Callable
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from hal.numerics import round_portable
from hal.robot import SensorReadings
from hal.robot_settings import RobotSettings
from kurt2rt.core.decision.decision import JunctionEvent
from kurt2rt.core.mid.junction_detector import JunctionDetector
from kurt2rt.core.mid.settings import MidSituation, MidSituationSettings
from kurt2rt.core.rla.condition import Condition, Metric

X, Y, EAST, NORTH, WALL_LEFT, WALL_RIGHT = range(6)
"""Index of each feature."""
_UNKNOWN_WALL = 0.5
_QUARTER_RAD = math.pi / 2
_HEADINGS = ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))
"""(east, north) by the number of left quarter turns, exact."""

KnownPlace = Callable[[NDArray[np.float64]], Condition | None]
"""Function from a situation (d,) to the condition of its place; None at an unknown place."""


class PlaceSettings(MidSituationSettings):
    """Settings of mid-level situations that are places: the dead-reckoned pose, in m."""

    heading_m: Annotated[float, Field(ge=0, le=100)]
    """Half the distance of two opposite headings at one point."""
    blind_m: Annotated[float, Field(ge=0, le=100)] = 0.0
    """Distance after a junction within which a straight passage is a gap in a wall."""

    @property
    def features(self) -> tuple[str, ...]:
        """Position and heading; then the walls of the last junction, of weight 0."""
        return ("x_m", "y_m", "east", "north", "wall_left", "wall_right")

    @property
    def weights(self) -> NDArray[np.float64]:
        """Weights, shape (6,); walls do not distinguish places, but goals can refer to them."""
        return np.array([1.0, 1.0, self.heading_m, self.heading_m, 0.0, 0.0])

    @property
    def metric(self) -> Metric:
        """Metric of places: Euclidean, in m."""
        return "euclidean"

    def build(self, detector: JunctionDetector, robot: RobotSettings) -> MidSituation:
        """Return the place at power-on, the origin of the dead reckoning."""
        return PlaceSituation(self, detector, robot)


class PlaceSituation:
    """Pose after the last junction, by dead reckoning, corrected at known places; constant between junctions.

    Streets meet at right angles, so the heading is a whole number of quarter turns and its error does not add up.
    """

    def __init__(self, settings: PlaceSettings, detector: JunctionDetector, robot: RobotSettings) -> None:
        self.features = settings.features
        self.dimensions = len(settings.features)
        self.passed: JunctionEvent | None = None
        self.known_place: KnownPlace | None = None
        """Function that corrects the position at known places; None: no correction."""
        self._blind_m = settings.blind_m
        self._detector = detector
        self._metres_per_tick = robot.geometry.metres_per_tick
        self._moved = False
        self._begin((0.0, 0.0, 1.0, 0.0, _UNKNOWN_WALL, _UNKNOWN_WALL))

    @property
    def lost(self) -> bool:
        """Return whether the position is unknown: the robot was repositioned and not localised since."""
        return bool(np.isnan(self.vector[X]))

    @property
    def since_m(self) -> float:
        """Distance in m that the robot drove since the situation changed last."""
        return self._way_m

    def perceive(self, readings: SensorReadings) -> bool:
        """Process one tick; return whether the situation changed."""
        moved, self._moved = self._moved, False
        self.passed = passed = self._detector.perceive(readings)
        self._reckon(readings)
        if passed is not None and passed.quarters == 0 and self._way_m < self._blind_m:
            self.passed = passed = None
        if passed is None or self.lost:
            return moved
        self._arrive(passed)
        return True

    def restart(self) -> None:
        """Set the position to unknown after the robot was repositioned."""
        self._begin((math.nan, math.nan, 1.0, 0.0, _UNKNOWN_WALL, _UNKNOWN_WALL))
        self._detector.restart()
        self.passed = None
        self._moved = True

    def localise(self, place: Condition) -> None:
        """Set the position to a place that the teacher named; dead reckoning continues from there."""
        self._begin(place)
        self._detector.restart()
        self.passed = None
        self._moved = True

    def _begin(self, place: Condition) -> None:
        self.vector: NDArray[np.float64] = np.array(place, dtype=np.float64)
        self._x_m, self._y_m = place[X], place[Y]
        self._quarters = round(round_portable(math.atan2(place[NORTH], place[EAST])) / _QUARTER_RAD) % 4
        self._begin_leg()

    def _begin_leg(self) -> None:
        """Start the displacement since a junction, in the frame of the encoders' yaw."""
        self._x_driven_m = self._y_driven_m = self._way_m = 0.0

    def _reckon(self, readings: SensorReadings) -> None:
        step_m = (readings.encoder_left_ticks + readings.encoder_right_ticks) / 2 * self._metres_per_tick
        middle_rad = self._detector.yaw_rad - self._detector.turn_rad / 2
        self._x_driven_m += step_m * round_portable(math.cos(middle_rad))
        self._y_driven_m += step_m * round_portable(math.sin(middle_rad))
        self._way_m += abs(step_m)

    def _arrive(self, passed: JunctionEvent) -> None:
        ahead_m, left_m = self._displacement_m(passed)
        east, north = _HEADINGS[self._quarters]
        self._x_m += ahead_m * east - left_m * north
        self._y_m += ahead_m * north + left_m * east
        self._quarters = (self._quarters + passed.quarters) % 4
        walls = (float(not passed.left_open), float(not passed.right_open))
        self.vector = np.array([self._x_m, self._y_m, *_HEADINGS[self._quarters], *walls])
        known = None if self.known_place is None else self.known_place(self.vector)
        if known is not None:
            self._x_m, self._y_m = known[X], known[Y]
        self._begin_leg()

    def _displacement_m(self, passed: JunctionEvent) -> tuple[float, float]:
        """Return the displacement in m, ahead and to the left, along the street that it began in.

        The error of the measured turn is taken to arise half-way on average. A straight passage has no left
        displacement, because wobbling between the walls does not add up.
        """
        street_rad = self._detector.street_rad
        assert street_rad is not None  # a junction follows a street
        surplus_rad = math.remainder(passed.turn_rad - passed.quarters * _QUARTER_RAD, 2 * math.pi)
        came_rad = street_rad - passed.turn_rad + surplus_rad / 2
        cos, sin = round_portable(math.cos(came_rad)), round_portable(math.sin(came_rad))
        ahead_m = self._x_driven_m * cos + self._y_driven_m * sin
        left_m = self._y_driven_m * cos - self._x_driven_m * sin
        return ahead_m, 0.0 if passed.quarters == 0 else left_m
