"""Doubt: its parts, its threshold, and the level that stands and asks at one."""

import numpy as np
import pytest

from behaviors.motor_primitive import MotorPrimitive
from hal.robot import STANDSTILL, WheelSpeeds
from kurt2rt.core.basic.basic_level import BasicLevel
from kurt2rt.core.basic.doubt import DoubtMeter, DoubtSettings, actions_ahead
from kurt2rt.core.decision.decision import ActiveBehaviour, Decision, DecisionCause
from kurt2rt.core.perception.perception import Situation
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.rla.rla_system import RlaSystem
from tests.core.helpers import sensed
from tests.core.rla.helpers import created

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


def test_robot_stands_and_asks_at_the_threshold() -> None:
    decision = Doubter(*LESSONS).at(230.0)
    assert (decision.cause, decision.asking, decision.driving) == (DecisionCause.DOUBT, True, False)
    assert decision.wheel_speeds == STANDSTILL
    assert decision.doubt == pytest.approx(2.0)
    assert decision.match is not None
    assert decision.match.rla.rla_id == 3


def test_doubt_that_only_tells_does_not_stop_the_robot() -> None:
    decision = Doubter(*LESSONS, settings=SETTINGS.model_copy(update={"asks": False})).at(230.0)
    assert decision.cause is DecisionCause.RLA
    assert decision.doubt == pytest.approx(2.0)


def test_obstacle_names_the_sensor_and_the_taught_reading() -> None:
    doubter = Doubter(*LESSONS)
    match = doubter.at(230.0).match
    assert match is not None
    found = doubter.level.new_obstacle(match, np.array([100.0, 230.0]))
    assert found is not None
    assert (found.feature, found.here, found.taught, found.counts) == (1, 230.0, 130.0, 100.0)
    assert doubter.level.new_obstacle(match, np.array([100.0, 130.0])) is None
    assert doubter.meter.obstacle(np.array([100.0, 230.0]), match, "spin", "") is None
