"""Level that drives by a reference policy, as a bound for what its teaching can reach."""

from behaviors.policies.policy import ReferencePolicy
from behaviors.repertoire import Repertoire
from hal.robot import STANDSTILL, SensorReadings
from kurt2rt.core.basic.held_action import HeldAction
from kurt2rt.core.decision.decision import ActiveBehaviour, Decision, DecisionCause, UnknownActionError
from kurt2rt.core.perception.perception import Situation


class PolicyLevel:
    """Level that drives by the teacher's own policy, for the drives that exams are compared with.

    Its actions have the same minimum time as those of a taught level.
    """

    def __init__(
        self,
        policy: ReferencePolicy,
        repertoire: Repertoire,
        minimum_action_ticks: int,
        active_behaviour: ActiveBehaviour,
    ) -> None:
        self._policy = policy
        self._repertoire = repertoire
        self._active_behaviour = active_behaviour
        self._behaviour = active_behaviour.behaviour
        self._held = HeldAction(repertoire, minimum_action_ticks)

    def decide(self, situation: Situation, readings: SensorReadings, blocking_cause: DecisionCause | None) -> Decision:  # noqa: ARG002 - the policy sees the readings
        """Return the decision to drive by the policy's action for the active behaviour, or to stand.

        It stands for `blocking_cause`. Raises UnknownActionError if the repertoire lacks the policy's action.
        """
        if self._behaviour != self._active_behaviour.behaviour:
            self._behaviour = self._active_behaviour.behaviour
            self._held.allow_switch()
        if blocking_cause is not None:
            self._held.stop()
            return Decision(STANDSTILL, blocking_cause, None, None, None)
        action = self._policy.choose(readings.infrared_counts, self._behaviour)
        if action not in self._repertoire:
            raise UnknownActionError(
                f"the policy says {action!r}, which the repertoire lacks; "
                f"add it there, or let the policy say one of: {', '.join(self._repertoire)}"
            )
        self._held.select(action)
        return Decision(self._held.step(readings), DecisionCause.TEACHER, self._held.name, None, None)
