"""The mid level's situation as a place: where the robot is by its wheels, and what it saw at the last junction."""

import math
from collections.abc import Callable
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from hal.robot import Senses
from hal.robot_settings import RobotSettings
from kurt2rt.layers.decision import Decision
from kurt2rt.mid.junction_detector import JunctionDetector
from kurt2rt.mid.junction_event import JunctionEvent
from kurt2rt.mid.situation import MidSituation, MidSituationSettings
from kurt2rt.mid.symbols.source import Transitions
from kurt2rt.rla.rla import Condition
from kurt2rt.rla.rla_system import Metric

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
        self.known: KnownPlace | None = None
        """Where there is one, the reckoning goes on from the places that it knows."""
        self._blind_m = settings.blind_m
        self._detector = detector
        self._metres_per_tick = robot.geometry.metres_per_tick
        self._track_m = robot.geometry.effective_track_m
        self._told = False
        self._begin((0.0, 0.0, 1.0, 0.0, _UNKNOWN_WALL, _UNKNOWN_WALL))

    @property
    def lost(self) -> bool:
        """Whether the robot does not know where it is: it was set down elsewhere, and nobody has said where."""
        return bool(np.isnan(self.vector[X]))

    @property
    def since_m(self) -> float:
        """Way driven since the situation changed."""
        return self._way_m

    def perceive(self, senses: Senses, before: Decision) -> bool:  # noqa: ARG002 - what was decided does not matter here
        """Take in one tick."""
        told, self._told = self._told, False
        self._reckon(senses)
        self.passed = passed = self._detector.perceive(senses)
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
        self._told = True

    def be_at(self, place: Condition) -> None:
        """Somebody says where the robot is: the reckoning goes on from there."""
        self._begin(place)
        self._detector.restart()
        self.passed = None
        self._told = True

    def _begin(self, place: Condition) -> None:
        self.vector: NDArray[np.float64] = np.array(place, dtype=np.float64)
        self._x_m, self._y_m = place[X], place[Y]
        self._quarters = round(math.atan2(place[NORTH], place[EAST]) / _QUARTER_RAD) % 4
        self._begin_leg()

    def _begin_leg(self) -> None:
        """From one junction to the next the way is reckoned in the frame of the street that it begins in."""
        self._ahead_m = self._left_m = self._turned_rad = self._way_m = 0.0

    def _reckon(self, senses: Senses) -> None:
        left_m = senses.encoder_left_ticks * self._metres_per_tick
        right_m = senses.encoder_right_ticks * self._metres_per_tick
        step_m, turn_rad = (left_m + right_m) / 2, (right_m - left_m) / self._track_m
        middle_rad = self._turned_rad + turn_rad / 2
        self._ahead_m += step_m * math.cos(middle_rad)
        self._left_m += step_m * math.sin(middle_rad)
        self._turned_rad += turn_rad
        self._way_m += abs(step_m)

    def _arrive(self, passed: JunctionEvent) -> None:
        ahead_m, left_m = self._straightened(passed.quarters)
        east, north = _HEADINGS[self._quarters]
        self._x_m += ahead_m * east - left_m * north
        self._y_m += ahead_m * north + left_m * east
        self._quarters = (self._quarters + passed.quarters) % 4
        walls = (float(not passed.left_open), float(not passed.right_open))
        self.vector = np.array([self._x_m, self._y_m, *_HEADINGS[self._quarters], *walls])
        known = None if self.known is None else self.known(self.vector)
        if known is not None:
            self._x_m, self._y_m = known[X], known[Y]
        self._begin_leg()

    def _straightened(self, quarters: int) -> tuple[float, float]:
        """The leg as it is if it ends in a street: what it turned too much or too little was wrong all the way."""
        off_rad = math.remainder(self._turned_rad - quarters * _QUARTER_RAD, 2 * math.pi) / 2
        cos, sin = math.cos(off_rad), math.sin(off_rad)
        ahead_m, left_m = self._ahead_m * cos + self._left_m * sin, self._left_m * cos - self._ahead_m * sin
        return (math.copysign(math.hypot(ahead_m, left_m), ahead_m), 0.0) if quarters == 0 else (ahead_m, left_m)
