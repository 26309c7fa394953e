"""Detection of junctions in simulated streets."""

import random
from collections.abc import Iterator

import pytest

from behaviors.metrics.junctions import Junctions
from behaviors.metrics.streets import Junction, Side, StreetMap
from behaviors.repertoire import load_repertoire
from hal.kurt2_settings import Kurt2Settings
from hal.robot import SensorReadings
from hal.robot_settings import InfraredSettings
from kurt2rt.core.basic.policy_level import PolicyLevel
from kurt2rt.core.decision.decision import ActiveBehaviour
from kurt2rt.core.mid.junction_detector import JunctionDetector
from kurt2rt.core.mid.settings import load_mid_level
from kurt2rt.core.perception.perception import Situation
from kurt2rt.core.task_settings import load_task
from simbridge.robot_simulation import Kurt2Simulation
from tests.core.helpers import situation
from tests.core.mid.walk import ROBOT

TASK = load_task("streets")
ANYWHERE: Situation = situation(0.0)  # the policy looks at the readings
_IN_A_STREET_M = 0.35


class Drive:
    """The policy drives; what is wanted may change in every tick."""

    def __init__(self, seed: int, robot: Kurt2Settings = ROBOT) -> None:
        self.simulation = Kurt2Simulation(robot, "manhattan", seed, "test")
        self.wanted = ActiveBehaviour(TASK.behaviours)
        self._level = PolicyLevel(
            TASK.policy.build(robot.infrared), load_repertoire(TASK.repertoire, robot), 10, self.wanted
        )
        self._period_s = robot.cycle_s

    def ticks(self, duration_s: float) -> Iterator[SensorReadings]:
        """Yield the sensor readings of each tick."""
        for tick in range(round(duration_s / self._period_s)):
            now_s = tick * self._period_s
            self.simulation.step()
            readings = self.simulation.robot.sense(now_s)
            self.simulation.robot.drive(self._level.decide(ANYWHERE, readings, None).wheel_speeds, now_s, now_s)
            yield readings
        self.simulation.close()


class Truth:
    """Which junctions the robot has really passed, seen from above: told when it is well in the next street."""

    def __init__(self, streets: StreetMap) -> None:
        self._streets = streets
        self._inside: Junction | None = None
        self._way = Side.EAST

    def passed(self, drive: Drive) -> tuple[int, bool, bool] | None:
        """Quarter turns, and whether there was a way to the left and to the right."""
        pose = drive.simulation.pose
        if self._inside is None:
            self._inside = self._streets.junction_at(pose)
            if self._inside is not None:
                self._way = self._inside.side_of(pose).turned(2)
            return None
        junction = self._inside
        if junction.holds(pose, _IN_A_STREET_M):
            return None
        self._inside = None
        quarters = (junction.side_of(pose) - self._way) % 4
        sides = (self._way.turned(1) in junction.arms, self._way.turned(-1) in junction.arms)
        return (-1 if quarters == 3 else quarters, *sides)


def random_drive(seed: int, duration_s: float, robot: Kurt2Settings) -> tuple[list[object], list[object]]:
    """Return the passed and the detected junctions of a random drive."""
    drive = Drive(seed, robot)
    streets = StreetMap(drive.simulation.plan)
    course = Junctions(streets, TASK.behaviours, random.Random(seed))
    course.reset(drive.simulation.pose)
    truth, detector = Truth(streets), JunctionDetector(load_mid_level("turns").junctions, robot)
    passed: list[object] = []
    told: list[object] = []
    for readings in drive.ticks(duration_s):
        event = detector.perceive(readings)
        if event is not None:
            told.append((event.quarters, event.left_open, event.right_open))
        course.update(drive.simulation.pose)
        drive.wanted.select(course.behaviour)
        really = truth.passed(drive)
        if really is not None:
            passed.append(really)
    # The last one may have been told and not be over, or be over and not be told.
    both = min(len(passed), len(told))
    assert max(len(passed), len(told)) - both <= 1
    return passed[:both], told[:both]


def noisy(robot: Kurt2Settings, **changes: float) -> Kurt2Settings:
    infrared: InfraredSettings = robot.infrared.model_copy(update=changes)
    return robot.model_copy(update={"infrared": infrared})


@pytest.mark.deep
@pytest.mark.parametrize("seed", range(4))
def test_detector_noisy_sensors_for_minutes(seed: int) -> None:
    for robot in (ROBOT, noisy(ROBOT, noise_share=0.05), noisy(ROBOT, gain_spread_share=0.08)):
        passed, told = random_drive(seed, 300.0, robot)
        assert len(passed) >= 45
        assert [each[0] for each in told] == [each[0] for each in passed]  # type: ignore[index]
