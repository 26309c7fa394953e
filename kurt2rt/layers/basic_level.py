"""The basic level: RLAs over the 72-D situation, of the taught behaviour that is wanted; actions of the repertoire."""

from behaviors.repertoire import Repertoire
from hal.robot import STANDSTILL, Senses
from kurt2rt.layers.decision import Cause, Decision
from kurt2rt.layers.held_action import HeldAction
from kurt2rt.layers.wanted import Wanted
from kurt2rt.perception.perception import Situation
from kurt2rt.rla.rla import RlaRewarded, SessionBegun, SessionEnded, TeachingEvent
from kurt2rt.rla.rla_system import Match, RlaSystem


class UnknownActionError(ValueError):
    """Knowledge, or a policy, names an action that the repertoire does not have."""


class UnknownBehaviourError(ValueError):
    """Knowledge names a taught behaviour that the task does not have."""


def _named(behaviour: str) -> str:
    return f"the behaviour {behaviour}" if behaviour else "a behaviour without a name, the only one of its task"


class BasicLevel:
    """Winner takes all, with a minimum time per action against dithering between neighbours."""

    def __init__(self, system: RlaSystem, repertoire: Repertoire, minimum_action_ticks: int, wanted: Wanted) -> None:
        """Raises UnknownActionError, or UnknownBehaviourError for RLAs that nothing which can be wanted would ask."""
        for rla in system.rlas:
            if rla.behaviour not in wanted.behaviours:
                raise UnknownBehaviourError(
                    f"RLA {rla.rla_id} belongs to {_named(rla.behaviour)}, and this task teaches "
                    f"{', '.join(wanted.behaviours) or 'one without a name'}; "
                    "give the task that this knowledge was taught with"
                )
            if rla.action not in repertoire:
                raise UnknownActionError(
                    f"RLA {rla.rla_id} has the action {rla.action}, which the repertoire lacks; "
                    f"add it there, or teach with the repertoire it came from: {', '.join(repertoire)}"
                )
        self.system = system
        self.repertoire = repertoire
        self.wanted = wanted
        self._pursued = wanted.behaviour
        self._held = HeldAction(repertoire, minimum_action_ticks)
        self._rla_id: int | None = None

    def apply(self, event: TeachingEvent) -> None:
        """Change the knowledge; what the robot does next follows it at once, whatever action was being held."""
        self.system.apply(event)
        if not isinstance(event, RlaRewarded | SessionBegun | SessionEnded):
            self._held.yield_next()

    def decide(self, situation: Situation, senses: Senses, stand_because: Cause | None) -> Decision:
        """Answer a situation: the winner's action, the held one, or standstill where it may not drive or knows none."""
        if self._pursued != self.wanted.behaviour:
            self._pursued = self.wanted.behaviour
            self._held.yield_next()
        match = self.system.match(situation.vector, self._pursued)
        if stand_because is not None:
            return self._stand(stand_because, match)
        if match is None or not match.known:
            return self._stand(Cause.UNKNOWN, match)
        cause = Cause.HELD
        if self._held.choose(match.rla.action):
            cause = Cause.RLA
            self._rla_id = match.rla.rla_id
        return Decision(self._held.step(senses), cause, self._held.name, self._rla_id, match)

    def _stand(self, cause: Cause, match: Match | None) -> Decision:
        """Stand; the next action begins anew."""
        self._held.stand()
        return Decision(STANDSTILL, cause, None, None, match)
