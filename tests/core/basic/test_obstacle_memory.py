"""Memory of obstacles: what it keeps, forgets and foresees, and the level that doubts by it."""

import numpy as np
import pytest

from behaviors.motor_primitive import MotorPrimitive
from hal.robot import SensorReadings, WheelSpeeds
from hal.robot_settings import load_robot
from kurt2rt.core.basic.basic_level import BasicLevel
from kurt2rt.core.basic.doubt import DoubtMeter, DoubtSettings, actions_ahead, set_points
from kurt2rt.core.basic.obstacle_memory import ContactSettings, ObstacleMemory
from kurt2rt.core.decision.decision import ActiveBehaviour, Decision
from kurt2rt.core.perception.perception import Situation
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.core.teaching.commands import Command, Resume
from kurt2rt.core.teaching.inbox import RobotRepositioned
from tests.core.helpers import sensed
from tests.core.rla.helpers import created
from tests.core.test_tick import Corridor
from tests.teacher.helpers import teach

ROBOT = load_robot()
SENSORS = ROBOT.infrared.names
SETTINGS = ContactSettings(memory_s=2.0, within_s=0.4, farthest_m=0.45, margin_m=0.0, look_s=0.05)
REPERTOIRE = {
    "forward": MotorPrimitive(WheelSpeeds(0.3, 0.3)),
    "spin": MotorPrimitive(WheelSpeeds(0.3, -0.3)),
    "back": MotorPrimitive(WheelSpeeds(-0.15, -0.15)),
}
ACTIONS = set_points(REPERTOIRE)
NOTHING = ROBOT.infrared.floor_counts
PERIOD_S = ROBOT.cycle_s
LOOK_TICKS = round(SETTINGS.look_s / PERIOD_S)


def readings(*, way_m: float = 0.0, **near_m: float) -> SensorReadings:
    """Return readings with obstacles at these distances from the named sensors, after driving straight on."""
    counts = [NOTHING] * len(SENSORS)
    for name, distance_m in near_m.items():
        counts[SENSORS.index(name)] = round(ROBOT.infrared.counts_at(distance_m))
    ticks = round(way_m / ROBOT.geometry.metres_per_tick)
    return sensed()._replace(infrared_counts=tuple(counts), encoder_left_ticks=ticks, encoder_right_ticks=ticks)


def look(memory: ObstacleMemory, *, way_m: float = 0.0, **near_m: float) -> None:
    """Let the robot drive the way, in m, until its next look, and see these obstacles there."""
    for _ in range(LOOK_TICKS - 1):
        memory.update(readings())
    memory.update(readings(way_m=way_m, **near_m))


def memory_of(settings: ContactSettings = SETTINGS) -> ObstacleMemory:
    return ObstacleMemory(settings, ROBOT, ACTIONS)


def test_obstacle_between_two_beams_is_remembered() -> None:
    memory = memory_of()
    look(memory, s9=0.12)
    look(memory, way_m=0.05)  # nothing in view by now
    contact = memory.contact("forward")
    assert contact is not None
    assert SENSORS[contact.sensor] == "s9"
    assert contact.seen_s == pytest.approx(LOOK_TICKS * PERIOD_S)
    assert contact.within_s == pytest.approx(0.3)
    assert memory.meets("forward")


def test_obstacle_near_the_outline_is_remembered_there() -> None:
    memory = memory_of()
    look(memory, s11=0.15)
    assert not memory.remembers_within(0.05)
    assert memory.remembers_within(0.16)
    look(memory, way_m=0.12)
    assert memory.remembers_within(0.05)


def test_obstacle_is_forgotten_after_driving_for_the_memory() -> None:
    memory = memory_of(SETTINGS.model_copy(update={"memory_s": 0.2}))
    look(memory, s11=0.10)
    looks = []
    for _ in range(4):
        look(memory, way_m=0.001)
        looks.append(memory.meets("forward"))
    assert looks == [True, True, True, False]


def test_far_readings_and_unknown_actions_meet_nothing() -> None:
    memory = memory_of(SETTINGS.model_copy(update={"farthest_m": 0.12}))
    look(memory, s11=0.14)
    assert not memory.meets("forward")
    look(memory, s11=0.10)
    assert memory.meets("forward")
    assert not memory.meets("dance")
    assert memory.contact("dance") is None


class Doubter:
    """A basic level over two readings that remembers obstacles, and one tick in a call."""

    def __init__(self, *events: TeachingEvent, contact: ContactSettings = SETTINGS, asks: bool = False) -> None:
        system = RlaSystem(2, 1000.0)
        system.apply_all(events)
        settings = DoubtSettings(
            usual_distance=0.1,
            rare_distance=0.5,
            rare_counts=50.0,
            threshold=2.0,
            asks=asks,
            alone=asks,
            contact=contact,
        )
        self.memory = ObstacleMemory(contact, ROBOT, ACTIONS)
        meter = DoubtMeter(system, settings, (1,), actions_ahead(REPERTOIRE), self.memory)
        self.level = BasicLevel(system, REPERTOIRE, 10, ActiveBehaviour(("",)), doubt=meter)
        self.level.skip_withdrawn = True

    def at(self, seen: SensorReadings, side: float = 200.0) -> Decision:
        return self.level.decide(Situation(np.array([side, 70.0]), history_frozen=False), seen, None)

    def after_a_look(self, side: float = 200.0) -> Decision:
        """Return the decision once the robot has seen an obstacle close ahead."""
        return [self.at(readings(s11=0.10), side) for _ in range(LOOK_TICKS)][-1]


LESSONS = (created(1, (100.0, 70.0), "forward"), created(2, (400.0, 70.0), "spin"), created(3, (500.0, 70.0), "back"))


def test_restarted_level_remembers_no_obstacle() -> None:
    robot = Doubter(*LESSONS)
    robot.after_a_look()
    robot.level.restart()
    assert not robot.memory.meets("forward")


@pytest.mark.parametrize(
    ("message", "times"), [(RobotRepositioned(), 1), (Resume("go", "Ann"), 1), (teach("back", "other"), 0)]
)
def test_robot_forgets_obstacles_when_it_was_moved(
    message: Command | RobotRepositioned, times: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    corridor = Corridor()
    corridor.run(100, teach("forward", "first"))
    forgot: list[int] = []
    monkeypatch.setattr(corridor.level, "forget_obstacles", lambda: forgot.append(corridor.ticks))
    corridor.inbox.put(message)
    corridor.run(100)
    assert forgot == [corridor.ticks] * times
