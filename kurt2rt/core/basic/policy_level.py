"""A layer that consults a reference policy in every tick: what the teacher would reach at the wheels itself."""

from behaviors.policies.policy import ReferencePolicy
from behaviors.repertoire import Repertoire
from hal.robot import STANDSTILL, SensorReadings
from kurt2rt.core.basic.held_action import HeldAction
from kurt2rt.core.decision.active_behaviour import ActiveBehaviour
from kurt2rt.core.decision.decision import Cause, Decision
from kurt2rt.core.decision.errors import UnknownActionError
from kurt2rt.core.perception.perception import Situation


class PolicyLevel:
    """Drives as the policy says, with the same minimum time per action as a taught level."""

    def __init__(
        self, policy: ReferencePolicy, repertoire: Repertoire, minimum_action_ticks: int, wanted: ActiveBehaviour
    ) -> None:
        self._policy = policy
        self._repertoire = repertoire
        self._wanted = wanted
        self._pursued = wanted.behaviour
        self._held = HeldAction(repertoire, minimum_action_ticks)

    def decide(self, situation: Situation, senses: SensorReadings, stand_because: Cause | None) -> Decision:  # noqa: ARG002 - the policy sees the senses
        """The policy's action for the behaviour that is wanted. Raises UnknownActionError."""
        if self._pursued != self._wanted.behaviour:
            self._pursued = self._wanted.behaviour
            self._held.yield_next()
        if stand_because is not None:
            self._held.stand()
            return Decision(STANDSTILL, stand_because, None, None, None)
        action = self._policy.choose(senses.infrared_counts, self._pursued)
        if action not in self._repertoire:
            raise UnknownActionError(
                f"the policy says {action!r}, which the repertoire lacks; "
                f"add it there, or let the policy say one of: {', '.join(self._repertoire)}"
            )
        self._held.choose(action)
        return Decision(self._held.step(senses), Cause.TEACHER, self._held.name, None, None)
