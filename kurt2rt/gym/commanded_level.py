"""Level that drives the action that an environment's agent commanded."""

from behaviors.repertoire import Repertoire
from hal.robot import STANDSTILL, SensorReadings
from kurt2rt.core.basic.held_action import HeldAction
from kurt2rt.core.decision.decision import Decision, DecisionCause
from kurt2rt.core.perception.perception import Situation


class CommandedLevel:
    """Level that drives the commanded action until the next command, and asks before the first one."""

    def __init__(self, repertoire: Repertoire) -> None:
        self._repertoire = repertoire
        self._held = HeldAction(repertoire, minimum_ticks=0)
        self._action: str | None = None

    def command(self, action: str) -> None:
        """Let an action drive from the next tick on; a finished one starts again.

        Raises KeyError for an action outside the repertoire.
        """
        if self._repertoire[action].finished:
            self._held.stop()
        self._action = action

    def decide(self, situation: Situation, readings: SensorReadings, blocking_cause: DecisionCause | None) -> Decision:  # noqa: ARG002 - the agent sees the situation
        """Return the decision to drive by the commanded action, or to stand for `blocking_cause`."""
        if blocking_cause is not None or self._action is None:
            self._held.stop()
            return Decision(STANDSTILL, blocking_cause or DecisionCause.UNKNOWN, None, None, None)
        self._held.select(self._action)
        return Decision(self._held.step(readings), DecisionCause.TEACHER, self._action, None, None)
