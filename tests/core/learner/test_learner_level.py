import numpy as np

from hal.robot import STANDSTILL
from kurt2rt.core.decision.decision import ActiveBehaviour, Decision, DecisionCause
from kurt2rt.core.learner.learner import Why
from kurt2rt.core.learner.learner_level import LearnerLevel
from kurt2rt.core.learner.learner_team import LearnerTeam
from kurt2rt.core.learner.rla_learner import RlaLearner
from tests.core.helpers import MINIMUM_TICKS, Counted, sensed, situation
from tests.core.learner.helpers import SETTING, label


class RobotWithLearner:
    """Level of an RLA learner with the actions a, b and c, and one tick in a call."""

    def __init__(self, behaviours: tuple[str, ...] = ("",)) -> None:
        self.actions = {name: Counted() for name in "abc"}
        self.team = LearnerTeam("rla", RlaLearner, SETTING, behaviours)
        self.active = ActiveBehaviour(behaviours)
        self.level = LearnerLevel(self.team, self.actions, MINIMUM_TICKS, self.active)

    def at(self, place: float, cause: DecisionCause | None = None) -> Decision:
        return self.level.decide(situation(place), sensed(), cause)

    def teach(self, place: float, action: str, command_id: str) -> None:
        self.level.teach(np.array([place]), self.active.behaviour, action, Why.ANSWER, command_id)


def test_action_that_is_lost_asks() -> None:
    robot = RobotWithLearner()
    robot.teach(0.0, "a", "t-1")
    robot.actions["a"].lost = True
    assert robot.at(0.0).asking


def test_another_behaviour_decides_at_once_by_its_own_lessons() -> None:
    robot = RobotWithLearner(("left", "right"))
    robot.teach(0.0, "a", "t-1")
    robot.at(0.0)
    robot.active.behaviour = "right"
    assert robot.at(0.0).asking
    robot.teach(0.0, "b", "t-2")
    assert robot.at(0.0).action == "b"
    robot.active.behaviour = "left"
    assert robot.at(0.0).action == "a"


def test_failed_learner_stands_also_in_the_middle_of_an_action() -> None:
    robot = RobotWithLearner()
    robot.teach(0.0, "a", "t-1")
    assert robot.at(0.0).driving
    robot.team.teach(label(1.0, "ask", "t-2"))  # the name that no RLA may have
    assert robot.at(0.0) == Decision(STANDSTILL, DecisionCause.LEARNER_FAILED, None, None, None)
    assert "InvalidEventError" in robot.team.failure
