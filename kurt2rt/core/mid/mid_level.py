"""The mid level: RLAs over the junctions that were passed; their actions are taught behaviours of the basic level."""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from hal.robot import SensorReadings
from kurt2rt.core.decision.active_behaviour import ActiveBehaviour
from kurt2rt.core.decision.decision import Decision, MidDecision
from kurt2rt.core.decision.errors import UnknownBehaviourError
from kurt2rt.core.mid.settings import MidSettings
from kurt2rt.core.mid.situation import MidSituation
from kurt2rt.core.rla.match import Match
from kurt2rt.core.rla.rla import MID, Rla
from kurt2rt.core.rla.rla_system import RlaSystem


class TieBreaker(Protocol):
    """Who says which of several RLAs on the very same condition commands: a plan, for instance."""

    def choose(self, group: tuple[Rla, ...], vector: NDArray[np.float64]) -> Rla | None:
        """One of the group, oldest first, at this mid-level situation; None: no wish, the nearest commands.

        Asked in every tick in which the mid level knows its situation.
        """
        ...


class MidLevel:
    """Winner takes all among mid-level RLAs; what they say is what the basic level is to pursue.

    Situation and knowledge change seldom, and only then the nearest RLA is looked up anew.
    """

    def __init__(
        self, system: RlaSystem, situation: MidSituation, settings: MidSettings, wanted: ActiveBehaviour
    ) -> None:
        """`wanted`: shared with the basic level, which follows what the mid level commands there.

        Raises UnknownBehaviourError for RLAs that command what the task does not teach.
        """
        for rla in system.rlas_at(MID):
            if rla.action not in wanted.behaviours and not rla.is_withdrawn:
                raise UnknownBehaviourError(
                    f"{rla.title} commands the behaviour {rla.action}, and this task teaches "
                    f"{', '.join(wanted.behaviours)}; give the task that this knowledge was taught with"
                )
        self.system = system
        self.situation = situation
        self.settings = settings
        self.tie_breaker: TieBreaker | None = None
        self._wanted = wanted
        self._overridden = self._answered_overridden = False
        self._match: Match | None = None
        self._changes = -1
        self._last = self._answer()

    @property
    def vector(self) -> NDArray[np.float64]:
        """The mid-level situation, shape (d,): the condition that a lesson would teach now. Never changed in place."""
        return self.situation.vector

    @property
    def commanded(self) -> str:
        """The behaviour that is wanted now."""
        return self._wanted.behaviour

    @property
    def overridden(self) -> bool:
        """Whether a teacher commands until the next junction has been passed."""
        return self._overridden

    def override(self, behaviour: str) -> None:
        """A teacher commands a behaviour until the next junction has been passed. Raises CommandRefusedError.

        Where one of the RLAs that know this very situation says so, too, it commands: what comes of it is its doing.
        """
        self._wanted.select(behaviour)
        self._overridden = True

    def end_override(self) -> None:
        """What a teacher commanded counts no more: the mid level commands from the next decision on."""
        self._overridden = False

    def restart(self) -> None:
        """Forget where the robot was: it has been set down elsewhere. What a teacher commanded goes on."""
        self.situation.restart()
        self._match = None
        self._changes = -1

    def decide(self, senses: SensorReadings, before: Decision) -> MidDecision:
        """Command a behaviour; `before`: the decision of the tick before. Changes what is wanted."""
        changed = self.situation.perceive(senses, before)
        event = self.situation.passed
        if event is not None:
            self._overridden = False
        if changed or self._changes != self.system.changes:
            self._match = self.system.match(self.situation.vector, level=MID)
            self._changes = self.system.changes
        elif event is None and self.tie_breaker is None and self._still_holds():
            return self._last
        self._last = self._answer()
        return self._last if event is None else self._last._replace(event=event)

    def _still_holds(self) -> bool:
        return self._answered_overridden == self._overridden and self._last.behaviour == self._wanted.behaviour

    def _answer(self) -> MidDecision:
        wanted, match = self._wanted, self._match
        self._answered_overridden = self._overridden
        if self._overridden:
            if match is not None and match.known:
                for rla in self.system.competitors(match.rla):
                    if rla.action == wanted.behaviour:
                        return MidDecision(rla.action, rla.rla_id, match, False, False, None)
            return MidDecision(wanted.behaviour, None, match, False, True, None)
        if match is None or not match.known:
            return MidDecision(wanted.behaviour, None, match, True, False, None)
        rla = match.rla
        if self.tie_breaker is not None:
            rla = self.tie_breaker.choose(self.system.competitors(rla), self.situation.vector) or rla
        wanted.select(rla.action)
        return MidDecision(rla.action, rla.rla_id, match, False, False, None)
