"""The mid level's situation as a place: where the robot is by its wheels, and what it saw at the last junction."""

import math
from collections.abc import Callable
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from hal.robot import SensorReadings
from hal.robot_settings import RobotSettings
from kurt2rt.core.decision.decision import Decision
from kurt2rt.core.decision.junction_event import JunctionEvent
from kurt2rt.core.mid.junction_detector import JunctionDetector
from kurt2rt.core.mid.situation import MidSituation, MidSituationSettings
from kurt2rt.core.mid.symbols.source import Transitions
from kurt2rt.core.numerics import round_portable
from kurt2rt.core.rla.condition import Condition
from kurt2rt.core.rla.space import Metric

X, Y, EAST, NORTH, WALL_LEFT, WALL_RIGHT = range(6)
"""Where each feature stands in the vector."""
_UNKNOWN_WALL = 0.5
_QUARTER_RAD = math.pi / 2
_HEADINGS = ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))
"""Of each number of quarter turns to the left, exactly."""

KnownPlace = Callable[[NDArray[np.float64]], Condition | None]
"""The condition of the place that a situation is at; None where it is at none that the robot knows."""


class PlaceSettings(MidSituationSettings):
    """A place, by dead reckoning."""

    heading_m: Annotated[float, Field(ge=0, le=100)]
    """Two places at one point with opposite headings count as twice so far apart."""
    blind_m: Annotated[float, Field(ge=0, le=100)] = 0.0
    """A junction gone straight through after less way than this since the last one is none, but a gap in a wall."""

    @property
    def features(self) -> tuple[str, ...]:
        """Position and heading; then, of no weight, whether walls stood beside the robot in the last junction."""
        return ("x_m", "y_m", "east", "north", "wall_left", "wall_right")

    @property
    def weights(self) -> NDArray[np.float64]:
        """What was seen at a junction tells no places apart; but goals can be about it."""
        return np.array([1.0, 1.0, self.heading_m, self.heading_m, 0.0, 0.0])

    @property
    def metric(self) -> Metric:
        """Metres."""
        return "euclidean"

    def build(
        self,
        detector: JunctionDetector,
        robot: RobotSettings,
        transitions: Transitions,  # noqa: ARG002 - it goes by nothing counted
    ) -> MidSituation:
        """The place where the robot is switched on: there its reckoning begins."""
        return Place(self, detector, robot)


class Place:
    """Position and heading behind the last junction, reckoned by the wheels and put right at places that are known.

    Streets run at right angles: behind each junction the heading is a whole number of quarter turns, so errors of the
    heading do not add up. Between junctions nothing changes.
    """

    def __init__(self, settings: PlaceSettings, detector: JunctionDetector, robot: RobotSettings) -> None:
        self.features = settings.features
        self.dimensions = len(settings.features)
        self.passed: JunctionEvent | None = None
        self.known_place: KnownPlace | None = None
        """Where there is one, the reckoning goes on from the places that it knows."""
        self._blind_m = settings.blind_m
        self._detector = detector
        self._metres_per_tick = robot.geometry.metres_per_tick
        self._moved = False
        self._begin((0.0, 0.0, 1.0, 0.0, _UNKNOWN_WALL, _UNKNOWN_WALL))

    @property
    def lost(self) -> bool:
        """Whether the robot does not know where it is: it was set down elsewhere, and nobody has said where."""
        return bool(np.isnan(self.vector[X]))

    @property
    def since_m(self) -> float:
        """Way driven since the situation changed."""
        return self._way_m

    def perceive(self, senses: SensorReadings, before: Decision) -> bool:  # noqa: ARG002 - what was decided does not matter here
        """Take in one tick."""
        told, self._moved = self._moved, False
        self.passed = passed = self._detector.perceive(senses)
        self._reckon(senses)
        if passed is not None and passed.quarters == 0 and self._way_m < self._blind_m:
            self.passed = passed = None
        if passed is None or self.lost:
            return told
        self._arrive(passed)
        return True

    def restart(self) -> None:
        """The robot was set down elsewhere: it is lost until somebody says where it is."""
        self._begin((math.nan, math.nan, 1.0, 0.0, _UNKNOWN_WALL, _UNKNOWN_WALL))
        self._detector.restart()
        self.passed = None
        self._moved = True

    def localise(self, place: Condition) -> None:
        """Somebody says where the robot is: the reckoning goes on from there."""
        self._begin(place)
        self._detector.restart()
        self.passed = None
        self._moved = True

    def _begin(self, place: Condition) -> None:
        self.vector: NDArray[np.float64] = np.array(place, dtype=np.float64)
        self._x_m, self._y_m = place[X], place[Y]
        self._quarters = round(math.atan2(place[NORTH], place[EAST]) / _QUARTER_RAD) % 4
        self._begin_leg()

    def _begin_leg(self) -> None:
        """From one junction to the next the way is reckoned in the frame of the encoders' own yaw."""
        self._x_driven_m = self._y_driven_m = self._way_m = 0.0

    def _reckon(self, senses: SensorReadings) -> None:
        step_m = (senses.encoder_left_ticks + senses.encoder_right_ticks) / 2 * self._metres_per_tick
        middle_rad = self._detector.yaw_rad - self._detector.turn_rad / 2
        self._x_driven_m += step_m * round_portable(math.cos(middle_rad))
        self._y_driven_m += step_m * round_portable(math.sin(middle_rad))
        self._way_m += abs(step_m)

    def _arrive(self, passed: JunctionEvent) -> None:
        ahead_m, left_m = self._along_the_street(passed)
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

    def _along_the_street(self, passed: JunctionEvent) -> tuple[float, float]:
        """The leg ahead and to the left, as seen along the street that it began in.

        What the encoders make of the turn more or less than whole quarters is wrong half-way through on average.
        Who goes straight on through a junction stays in line: how he strays between the walls does not add up.
        """
        street_rad = self._detector.street_rad
        assert street_rad is not None  # nobody passes a junction without having been in a street
        surplus_rad = math.remainder(passed.turn_rad - passed.quarters * _QUARTER_RAD, 2 * math.pi)
        came_rad = street_rad - passed.turn_rad + surplus_rad / 2
        cos, sin = round_portable(math.cos(came_rad)), round_portable(math.sin(came_rad))
        ahead_m = self._x_driven_m * cos + self._y_driven_m * sin
        left_m = self._y_driven_m * cos - self._x_driven_m * sin
        return ahead_m, 0.0 if passed.quarters == 0 else left_m
