"""Scripted teacher of the mid level: it knows the right behaviour at each junction, answers and corrects."""

import random
from collections.abc import Sequence

from behaviors.metrics.task_metric import WayAhead
from kurt2rt.core.rla.rla import MID, SCRIPTED, Phase
from kurt2rt.core.teaching.commands import Command, Correct, Pursue, Teach
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.teacher.scripted.press_times import PressTimes

_NOTICED_WITHIN_S = 3.0
"""Time within which the robot reports a junction that it has left; later the junction counts as missed."""


class ScriptedDispatcher:
    """Teacher of the mid level with the robot's position on its route.

    A correction is given after the robot has noticed the last junction, because until then its situation is still that
    of the junction before. If the robot misses a junction, there is no situation to teach: the behaviour is commanded.
    """

    def __init__(
        self, behaviours: Sequence[str], times: PressTimes, *, period_s: float, seed: int, session: str
    ) -> None:
        """Teach these behaviours at these `times`; `session` is the prefix of command ids, as in ScriptedTeacher."""
        self._behaviours = tuple(behaviours)
        self._session = session
        self._times = times
        self._question_ticks = self._mistake_ticks = 0
        self._noticed_within_ticks = round(_NOTICED_WITHIN_S / period_s)
        self._chance = random.Random(f"errors at the mid level in {session}, seed {seed}")
        self._command_count = 0
        self._passed = 0
        self._early = False
        """The robot has noticed the junction that it is about to leave."""
        self._unnoticed_ticks = 0
        """Ticks since a junction that the robot has not noticed yet; 0: there is none."""
        self._ticks_asked = self._ticks_wrong = 0
        self.phase = Phase.SUPERVISED
        self.missed = 0
        """Number of junctions that the robot did not notice."""

    def on_tick(self, record: TickRecord, ahead: WayAhead) -> Command | None:
        """Return the teacher's command in response to one tick, None without one.

        `ahead`: position of the robot on its route.
        """
        mid = record.decision.mid
        assert mid is not None
        self._track_junctions(ahead, noticed=mid.event is not None)
        right = ahead.after if self._early else ahead.here
        if self._unnoticed_ticks:
            return self._command_if_missed(right, driving=record.decision.driving)
        if mid.asks:
            self._ticks_wrong = 0
            if self._ticks_asked == 0:
                self._question_ticks = self._times.question_ticks()
            self._ticks_asked += 1
            if self._ticks_asked < self._question_ticks or not self._times.allows_press():
                return None
            self._ticks_asked = 0
            return Teach(self._next_id(), SCRIPTED, self._choose(right, self._times.answer_errors), level=MID)
        self._ticks_asked = 0
        if self.phase is not Phase.CORRECTIONS or mid.overridden or mid.behaviour == right:
            self._ticks_wrong = 0
            return None
        if self._ticks_wrong == 0:
            self._mistake_ticks = self._times.mistake_ticks()
        self._ticks_wrong += 1
        if self._ticks_wrong < self._mistake_ticks or not self._times.allows_press():
            return None
        self._ticks_wrong = 0
        return Correct(self._next_id(), SCRIPTED, self._choose(right, self._times.correction_errors), level=MID)

    def _track_junctions(self, ahead: WayAhead, *, noticed: bool) -> None:
        if ahead.passed != self._passed:
            self._passed = ahead.passed
            self._unnoticed_ticks = 0 if self._early else 1
            self._early = False
        if noticed:
            self._early = ahead.inside
            self._unnoticed_ticks = 0

    def _command_if_missed(self, right: str, *, driving: bool) -> Command | None:
        """Return the right behaviour as a command once a junction has stayed unnoticed for too long."""
        self._ticks_asked = self._ticks_wrong = 0
        self._unnoticed_ticks += driving
        if self._unnoticed_ticks <= self._noticed_within_ticks:
            return None
        self._unnoticed_ticks = 0
        self.missed += 1
        return Pursue(self._next_id(), SCRIPTED, right)

    def _choose(self, right: str, error_rate: float) -> str:
        if self._chance.random() >= error_rate:
            return right
        return self._chance.choice([each for each in self._behaviours if each != right])

    def _next_id(self) -> str:
        self._command_count += 1
        return f"{self._session}-mid-{self._command_count}"
