"""Pose by dead reckoning from junction to junction, corrected at known places."""

import math
from collections.abc import Iterator

import numpy as np
import pytest

from behaviors.repertoire import load_repertoire
from hal.kurt2_settings import load_kurt2
from kurt2rt.core.basic.policy_level import PolicyLevel
from kurt2rt.core.decision.decision import ActiveBehaviour
from kurt2rt.core.mid.place import EAST, NORTH, WALL_LEFT, WALL_RIGHT, PlaceSituation, X, Y
from kurt2rt.core.mid.settings import load_mid_level
from kurt2rt.core.perception.perception import Situation
from kurt2rt.core.rla.condition import Condition
from kurt2rt.core.task_settings import load_task
from simbridge.contracts.simulation import Pose
from simbridge.robot_simulation import Kurt2Simulation

ROBOT = load_kurt2()
STREETS = load_task("streets")
PLACES = load_mid_level("places")
NOWHERE = Situation(np.zeros(1), history_frozen=False)


def place() -> PlaceSituation:
    built = PLACES.build(ROBOT)
    assert isinstance(built, PlaceSituation)
    return built


class Drive:
    """The robot in Manhattan, led by one who knows the streets, and what it reckons."""

    def __init__(self, place: PlaceSituation, start: Pose) -> None:
        self.place = place
        self.simulation = Kurt2Simulation(ROBOT, "manhattan", 1, "reckoning")
        self.simulation.simulated_robot.place(start)
        self._wanted = ActiveBehaviour(STREETS.behaviours)
        self._leader = PolicyLevel(
            STREETS.policy.build(ROBOT.infrared), load_repertoire(STREETS.repertoire, ROBOT), 10, self._wanted
        )
        self._tick = 0

    def lead(self, *behaviours: str) -> None:
        """Drive through several junctions."""
        for behaviour in behaviours:
            self._wanted.select(behaviour)
            while not self.step():
                assert self._tick < 20_000, "no junction was noticed"

    def step(self) -> bool:
        """One tick; whether a junction was passed."""
        self._tick += 1
        now_s = self._tick * ROBOT.cycle_s
        readings = self.simulation.robot.sense(now_s)
        changed = self.place.perceive(readings)
        decision = self._leader.decide(NOWHERE, readings, None)
        self.simulation.robot.drive(decision.wheel_speeds, now_s, now_s)
        self.simulation.step()
        return changed and self.place.passed is not None

    @property
    def off_m(self) -> float:
        """Return the error of the reckoned position in m."""
        pose, vector = self.simulation.pose, self.place.vector
        return math.hypot(vector[X] - pose.x_m, vector[Y] - pose.y_m)


NORTHWARD = Pose(2.2, 3.1, math.pi / 2)
AT_START: Condition = (2.2, 3.1, 0.0, 1.0, 0.5, 0.5)


@pytest.fixture
def drive() -> Iterator[Drive]:
    drives = Drive(place(), NORTHWARD)
    drives.place.localise(AT_START)
    yield drives
    drives.simulation.close()


def heading(place: PlaceSituation) -> tuple[float, float]:
    return place.vector[EAST], place.vector[NORTH]


def test_place_tracks_pose_behind_each_junction(drive: Drive) -> None:
    drive.lead("turn_right")
    assert heading(drive.place) == (1.0, 0.0)
    assert drive.off_m < 0.15
    drive.lead("straight_on", "turn_left", "turn_left")  # the last in a corner of the town
    assert heading(drive.place) == (-1.0, 0.0)
    assert drive.off_m < 0.3
    assert (drive.place.vector[WALL_LEFT], drive.place.vector[WALL_RIGHT]) == (0.0, 1.0)


def test_place_is_constant_between_junctions(drive: Drive) -> None:
    before = drive.place.vector
    while not drive.step():
        pass
    assert drive.place.vector is not before
    assert tuple(before) == AT_START


def test_place_opposite_headings_are_distinct() -> None:
    space = PLACES.space
    assert space.weights is not None
    apart = np.array([0.0, 0.0, 2.0, 0.0, 1.0, 1.0]) * space.weights
    assert np.linalg.norm(apart) > space.radius
    assert PLACES.situation.describe(AT_START)[:2] == ("x_m 2.20", "y_m 3.10")
