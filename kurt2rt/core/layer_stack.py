"""Layer stack: information goes up to the mid level, its command comes down to the basic level."""

from hal.robot import SensorReadings
from kurt2rt.core.decision.decision import Decision, DecisionCause, GoalStatus, Level, stopped
from kurt2rt.core.mid.mid_level import MidLevel
from kurt2rt.core.perception.perception import Situation
from kurt2rt.core.planning.navigator import Navigator
from kurt2rt.core.rla.rla import MID

GOAL_CAUSES: dict[GoalStatus | None, DecisionCause] = {
    GoalStatus.ARRIVED: DecisionCause.AT_GOAL,
    GoalStatus.NO_WAY: DecisionCause.NO_WAY,
}
"""Causes by which a goal stops the robot, even if the mid level has a command."""


class LayerStack:
    """Mid level over a basic level (paper, section V); itself a Level, so the tick calls one level.

    In each tick the mid level chooses the active behaviour first, then the basic level decides among its RLAs. While
    the mid level asks, the robot stands. A goal's `Navigator` breaks ties between equally near mid-level RLAs.
    """

    def __init__(self, basic: Level, mid: MidLevel, navigator: Navigator | None = None) -> None:
        """Connect two levels that share one ActiveBehaviour: the mid level sets it, the basic level reads it.

        `navigator` leads the mid level to a goal while there is one.
        """
        self.basic = basic
        self.mid = mid
        self.navigator = navigator

    def decide(self, situation: Situation, readings: SensorReadings, blocking_cause: DecisionCause | None) -> Decision:
        """Return the basic level's decision for the mid level's command; the robot stands while the mid level asks.

        `situation`: of the basic level. `blocking_cause`: reason to stand; None: the levels decide.
        """
        commanded = self.mid.decide(readings)
        navigator = self.navigator
        if navigator is not None:
            navigator.step()
        if commanded.asks:
            decision = self._decide_below(situation, readings, blocking_cause or DecisionCause.UNKNOWN)
            decision = decision._replace(match=commanded.match, asks_at=MID, mid=commanded)
        else:
            if navigator is not None and not self.mid.overridden:
                blocking_cause = blocking_cause or GOAL_CAUSES.get(navigator.standing_status)
            decision = self._decide_below(situation, readings, blocking_cause)
            decision = decision._replace(mid=commanded)
        if navigator is not None:
            decision = decision._replace(plan=navigator.status)
        return decision

    def restart(self) -> None:
        """Reset the mid level after the robot was repositioned."""
        self.mid.restart()

    def _decide_below(
        self, situation: Situation, readings: SensorReadings, blocking_cause: DecisionCause | None
    ) -> Decision:
        return stopped(self.basic.decide(situation, readings, blocking_cause), blocking_cause)
