"""Doubt: its parts, its threshold, and the level that stands and asks at one."""

import numpy as np
import pytest

from behaviors.motor_primitive import MotorPrimitive
from hal.robot import STANDSTILL, WheelSpeeds
from hal.robot_settings import load_robot
from kurt2rt.core.basic.basic_level import BasicLevel
from kurt2rt.core.basic.doubt import DoubtMeter, DoubtSettings, DoubtWatch, actions_ahead, features_ahead
from kurt2rt.core.decision.active_behaviour import ActiveBehaviour
from kurt2rt.core.decision.decision import Decision, DecisionCause
from kurt2rt.core.perception.definition import load_situation
from kurt2rt.core.perception.perception import Situation
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.core.task_settings import load_task
from kurt2rt.knowledge.task_repertoire import load_task_repertoire
from tests.core.helpers import sensed
from tests.core.rla.helpers import created, deleted, replaced

SETTINGS = DoubtSettings(usual_distance=0.1, rare_distance=0.5, rare_counts=50.0, threshold=2.0)
REPERTOIRE = {
    "forward": MotorPrimitive(WheelSpeeds(0.3, 0.3)),
    "spin": MotorPrimitive(WheelSpeeds(-0.2, 0.2)),
    "back": MotorPrimitive(WheelSpeeds(-0.1, -0.1)),
}
LESSONS = (
    created(1, (100.0, 70.0), "forward"),
    created(2, (100.0, 120.0), "forward"),
    created(3, (100.0, 130.0), "forward"),
    created(4, (100.0, 400.0), "spin"),
)
"""Readings ahead at which the robot was taught to drive on: 70, 120 and 130 counts."""


class Doubter:
    """A basic level over a side sensor and one ahead, and one tick in a call."""

    def __init__(self, *events: TeachingEvent, settings: DoubtSettings = SETTINGS) -> None:
        system = RlaSystem(2, 1000.0)
        system.apply_all(events)
        self.meter = DoubtMeter(system, settings, (1,), actions_ahead(REPERTOIRE))
        self.level = BasicLevel(system, REPERTOIRE, 0, ActiveBehaviour(("",)), doubt=self.meter)

    def at(self, ahead: float, side: float = 100.0) -> Decision:
        return self.level.decide(Situation(np.array([side, ahead]), history_frozen=False), sensed(), None)


def test_distance_counts_from_the_usual_one_to_the_rare_one() -> None:
    doubter = Doubter(*LESSONS)
    assert doubter.at(70.0, side=200.0).doubt == pytest.approx(0.0)
    assert doubter.at(70.0, side=600.0).doubt == pytest.approx(1.0)


def test_an_obstacle_is_new_beyond_all_lessons_but_one() -> None:
    far = created(5, (400.0, 200.0))
    assert Doubter(*LESSONS, far).at(170.0).doubt == pytest.approx((170.0 - 130.0) / 50.0)


def test_one_wrong_lesson_does_not_hide_an_obstacle() -> None:
    wrong = created(5, (900.0, 600.0), "forward")
    assert Doubter(*LESSONS, wrong).at(230.0).cause is DecisionCause.DOUBT


def test_robot_stands_and_asks_at_the_threshold() -> None:
    decision = Doubter(*LESSONS).at(230.0)
    assert (decision.cause, decision.asking, decision.driving) == (DecisionCause.DOUBT, True, False)
    assert decision.wheel_speeds == STANDSTILL
    assert decision.doubt == pytest.approx(2.0)
    assert decision.match is not None
    assert decision.match.rla.rla_id == 3


@pytest.mark.parametrize("action", ["spin", "back"])
def test_action_that_does_not_drive_on_meets_no_obstacle(action: str) -> None:
    turned = replaced(3, action, "forward")
    assert Doubter(*LESSONS, turned).at(230.0).doubt == 0.0


def test_lesson_that_is_deleted_leaves_the_obstacle_new_again() -> None:
    taught = (created(5, (100.0, 230.0)), created(6, (900.0, 230.0)))
    doubter = Doubter(*LESSONS, *taught)
    assert doubter.at(230.0).doubt == 0.0
    for rla_id in (5, 6):
        doubter.level.apply(deleted(rla_id))
    assert doubter.at(230.0).cause is DecisionCause.DOUBT


def test_a_doubt_ends_below_the_threshold_by_a_fifth() -> None:
    watch = DoubtWatch(Doubter(*LESSONS).meter)
    assert [watch.update(score, alone=False) for score in (1.9, 2.0, 1.7, 1.5, 1.7)] == [
        False,
        True,
        True,
        False,
        False,
    ]
    watch.update(2.0, alone=False)
    watch.end()
    assert not watch.update(1.7, alone=False)


def test_doubt_that_only_tells_does_not_stop_the_robot() -> None:
    decision = Doubter(*LESSONS, settings=SETTINGS.model_copy(update={"asks": False})).at(230.0)
    assert decision.cause is DecisionCause.RLA
    assert decision.doubt == pytest.approx(2.0)


@pytest.mark.parametrize("alone", [False, True])
def test_robot_without_a_teacher_stands_only_if_it_is_set(alone: bool) -> None:
    doubter = Doubter(*LESSONS, settings=SETTINGS.model_copy(update={"alone": alone}))
    doubter.level.skip_withdrawn = True
    assert doubter.at(230.0).asking is alone


def test_obstacle_names_the_sensor_and_the_taught_reading() -> None:
    doubter = Doubter(*LESSONS)
    match = doubter.at(230.0).match
    assert match is not None
    found = doubter.level.new_obstacle(match, np.array([100.0, 230.0]))
    assert found is not None
    assert (found.feature, found.here, found.taught, found.counts) == (1, 230.0, 130.0, 100.0)
    assert doubter.level.new_obstacle(match, np.array([100.0, 130.0])) is None
    assert doubter.meter.obstacle(np.array([100.0, 230.0]), match, "spin", "") is None


def test_five_sensors_of_kurt2_look_ahead() -> None:
    robot = load_robot()
    definition = load_situation("basic", robot.infrared.names)
    ahead = [definition.names[index] for index in features_ahead(definition, robot.infrared)]
    assert ahead == ["s9", "s10", "s11", "s15", "s16"]


def test_actions_ahead_have_a_speed_of_their_own() -> None:
    assert actions_ahead(REPERTOIRE) == {"forward"}
    shipped = load_repertoire_of("wall_following")
    assert {"forward", "sharp_left", "along_left_wall"} <= shipped
    assert not shipped & {"spin_left", "stand", "back", "quarter_turn_left"}


def load_repertoire_of(task: str) -> frozenset[str]:
    return actions_ahead(load_task_repertoire(load_task(task), load_robot()))
