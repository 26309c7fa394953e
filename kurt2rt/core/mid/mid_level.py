"""Mid level: RLAs over the passed junctions, whose actions are taught behaviours of the basic level."""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from hal.robot import SensorReadings
from kurt2rt.core.decision.decision import ActiveBehaviour, Decision, DecisionCause, MidDecision, UnknownBehaviourError
from kurt2rt.core.mid.settings import MidSettings, MidSituation
from kurt2rt.core.rla.active_rlas import Match
from kurt2rt.core.rla.rla import MID, Rla
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.core.rla.statistics import StatisticsCounter


class TieBreaker(Protocol):
    """Choice among RLAs with an equal condition, for instance by a plan."""

    def choose(self, group: tuple[Rla, ...], vector: NDArray[np.float64]) -> Rla | None:
        """Return an RLA of a group with equal conditions, oldest first; None: the nearest one commands.

        `vector`: mid-level situation, shape (d,). Called in each tick in which the mid level knows its situation.
        """
        ...


class MidLevel:
    """Level that chooses a taught behaviour at junctions (paper, section V), such as turn_left after two crossings.

    Its situation is the last junctions (the paper counts twelve, R 6), or a place. The action of the nearest mid-level
    RLA inside R becomes the basic level's active behaviour; beyond R it asks for the way.

    The search runs only after a change of situation or knowledge.
    """

    def __init__(
        self, system: RlaSystem, situation: MidSituation, settings: MidSettings, wanted: ActiveBehaviour
    ) -> None:
        """`wanted`: active behaviour, shared with the basic level.

        Raises UnknownBehaviourError for an RLA whose behaviour the task does not have.
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
        self.overridden = self._answered_overridden = False
        """Whether a teacher's override holds, until the next junction is passed."""
        self._match: Match | None = None
        self._changes = -1
        self._last = self._answer()

    @property
    def vector(self) -> NDArray[np.float64]:
        """Mid-level situation, shape (d,): the condition of a lesson given now. Never changed in place."""
        return self.situation.vector

    @property
    def commanded(self) -> str:
        """Name of the behaviour that the basic level drives by."""
        return self._wanted.behaviour

    def override(self, behaviour: str) -> None:
        """Command a behaviour until the next junction is passed. Raises CommandRefusedError for an unknown one.

        If an RLA of this situation has the same action, that RLA commands and gets the use counted.
        """
        self._wanted.select(behaviour)
        self.overridden = True

    def end_override(self) -> None:
        """End the override: the mid level commands from the next decision on."""
        self.overridden = False

    def restart(self) -> None:
        """Reset the situation after the robot was repositioned; an override stays."""
        self.situation.restart()
        self._match = None
        self._changes = -1

    def decide(self, readings: SensorReadings) -> MidDecision:
        """Return the command of this tick and activate its behaviour.

        The decision asks if no RLA knows the mid-level situation and no teacher overrides it.
        """
        changed = self.situation.perceive(readings)
        event = self.situation.passed
        if event is not None:
            self.overridden = False
        if changed or self._changes != self.system.changes:
            self._match = self.system.match(self.situation.vector, level=MID)
            self._changes = self.system.changes
        elif event is None and self.tie_breaker is None and self._still_holds():
            return self._last
        self._last = self._answer()
        return self._last if event is None else self._last._replace(event=event)

    def _still_holds(self) -> bool:
        return self._answered_overridden == self.overridden and self._last.behaviour == self._wanted.behaviour

    def _answer(self) -> MidDecision:
        wanted, match = self._wanted, self._match
        self._answered_overridden = self.overridden
        if self.overridden:
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


class MidUsageCounter:
    """Counter of uses of mid-level RLAs: one for each junction that an RLA led the robot through.

    RLAs corrected before the junction, overrides and manual driving do not count. A robot that stands on its way is
    still on it.
    """

    def __init__(self, counter: StatisticsCounter) -> None:
        """`counter`: common to all levels."""
        self._counter = counter
        self._leads: int | None = None

    def count(self, decision: Decision, *, driving: bool) -> None:
        """Count one tick; `driving`: whether the wheels turned for this decision."""
        mid = decision.mid
        if mid is None:
            return
        if mid.event is not None:
            self._counter.count(self._leads, MID, again=True)
        if driving:
            by_teacher = mid.overridden or decision.cause is DecisionCause.TEACHER
            self._leads = None if by_teacher else mid.rla_id

    def restart(self) -> None:
        """Count no transition into the next RLA."""
        self._counter.count(None, MID)
        self._leads = None
