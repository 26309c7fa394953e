"""A layer that consults a reference policy in every tick: what the teacher would reach at the wheels itself."""

from behaviors.behaviour import Behaviour
from behaviors.policies.policy import ReferencePolicy
from behaviors.repertoire import Repertoire
from hal.robot import STANDSTILL, Senses
from kurt2rt.layers.decision import Cause, Decision
from kurt2rt.perception.perception import Situation


class PolicyLevel:
    """Drives as the policy says, with the same minimum time per action as a taught level."""

    def __init__(self, policy: ReferencePolicy, repertoire: Repertoire, minimum_action_ticks: int) -> None:
        self._policy = policy
        self._repertoire = repertoire
        self._minimum_action_ticks = minimum_action_ticks
        self._active: Behaviour | None = None
        self._action = ""
        self._ticks_active = 0

    def decide(self, situation: Situation, senses: Senses, stand_because: Cause | None) -> Decision:  # noqa: ARG002 - the policy sees the senses
        """The policy's action."""
        if stand_because is not None:
            self._active = None
            return Decision(STANDSTILL, stand_because, None, None, None)
        action = self._policy.choose(senses.infrared_counts)
        active = self._active
        if active is None or (action != self._action and self._ticks_active >= self._minimum_action_ticks):
            active = self._active = self._repertoire[action]
            active.start()
            self._action = action
            self._ticks_active = 0
        self._ticks_active += 1
        return Decision(active.step(senses), Cause.TEACHER, self._action, None, None)
