"""A scripted teacher of the mid level: knows what is right at each junction, and answers and corrects by that."""

import random
from collections.abc import Sequence

from behaviors.metrics.task_metric import WayAhead
from kurt2rt.core.rla.programs import SCRIPTED
from kurt2rt.core.rla.rla import MID, Phase
from kurt2rt.core.task_settings import TeacherSettings
from kurt2rt.core.teaching.commands import Command, Correct, Pursue, Teach
from kurt2rt.core.tick import TickRecord

_NOTICES_WITHIN_S = 3.0
"""From a junction that it has left behind to where the robot says so; later it has missed the junction."""


class ScriptedDispatcher:
    """Sees where the robot is on its route, and what its mid level wants.

    Corrects what is wanted before the robot comes to the junction, once it has noticed that it left the one before:
    until then its situation is still that of the junction before. Where it does not notice that, there is no situation
    to teach, and he commands.
    """

    def __init__(
        self, behaviours: Sequence[str], settings: TeacherSettings, *, period_s: float, seed: int, session: str
    ) -> None:
        """`session` begins the ids of all his commands, as in ScriptedTeacher."""
        self._behaviours = tuple(behaviours)
        self._session = session
        self._error_rate = settings.error_rate
        self._reaction_ticks = round(settings.reaction_s / period_s)
        self._patience_ticks = round(settings.patience_s / period_s)
        self._notices_within_ticks = round(_NOTICES_WITHIN_S / period_s)
        self._chance = random.Random(f"errors at the mid level in {session}, seed {seed}")
        self._said = 0
        self._passed = 0
        self._early = False
        """Whether the robot has noticed the junction already that it is about to leave."""
        self._unnoticed_ticks = 0
        """Since it left a junction that it has not noticed yet; 0: there is none."""
        self._asked_ticks = self._otherwise_ticks = 0
        self.phase = Phase.SUPERVISED
        self.missed = 0
        """Junctions that the robot did not notice."""

    def watch(self, record: TickRecord, ahead: WayAhead) -> Command | None:
        """See one tick; what he says to it, if anything."""
        mid = record.decision.mid
        assert mid is not None
        self._follow(ahead, noticed=mid.event is not None)
        right = ahead.after if self._early else ahead.here
        if self._unnoticed_ticks:
            return self._command(right, driving=record.decision.driving)
        if mid.asks:
            self._otherwise_ticks = 0
            self._asked_ticks += 1
            if self._asked_ticks < self._reaction_ticks:
                return None
            self._asked_ticks = 0
            return Teach(self._next_id(), SCRIPTED, self._choose(right), level=MID)
        self._asked_ticks = 0
        if self.phase is not Phase.CORRECTIONS or mid.overridden or mid.behaviour == right:
            self._otherwise_ticks = 0
            return None
        self._otherwise_ticks += 1
        if self._otherwise_ticks < self._patience_ticks:
            return None
        self._otherwise_ticks = 0
        return Correct(self._next_id(), SCRIPTED, self._choose(right), level=MID)

    def _follow(self, ahead: WayAhead, *, noticed: bool) -> None:
        """Which junction the robot's mid level is about."""
        if ahead.passed != self._passed:
            self._passed = ahead.passed
            self._unnoticed_ticks = 0 if self._early else 1
            self._early = False
        if noticed:
            self._early = ahead.inside
            self._unnoticed_ticks = 0

    def _command(self, right: str, *, driving: bool) -> Command | None:
        """The robot is past a junction, and does not know it: say what is wanted when that has lasted too long."""
        self._asked_ticks = self._otherwise_ticks = 0
        self._unnoticed_ticks += driving
        if self._unnoticed_ticks <= self._notices_within_ticks:
            return None
        self._unnoticed_ticks = 0
        self.missed += 1
        return Pursue(self._next_id(), SCRIPTED, right)

    def _choose(self, right: str) -> str:
        if self._chance.random() >= self._error_rate:
            return right
        return self._chance.choice([each for each in self._behaviours if each != right])

    def _next_id(self) -> str:
        self._said += 1
        return f"{self._session}-mid-{self._said}"
