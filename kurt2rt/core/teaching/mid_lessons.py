"""What a teacher says of the way to go: lessons of the mid level, and commands in its place."""

import numpy as np

from kurt2rt.core.decision.decision import Decision
from kurt2rt.core.mid.mid_level import MidLevel
from kurt2rt.core.outcome import CommandRefusedError, RefusalCode
from kurt2rt.core.rla.rla import MID
from kurt2rt.core.teaching.commands import Correct, Teach
from kurt2rt.core.teaching.lesson_context import LessonContext
from kurt2rt.core.teaching.mid_history import MidHistory


class MidLessons:
    """Remembers what the mid level decided, so that a teacher can mean it, and lets him go before it."""

    def __init__(self, mid: MidLevel) -> None:
        self.mid = mid
        self.passed_at_tick = -1
        """When a junction had been passed last: what was said before it was about that one."""
        self._history = MidHistory()

    def remember(self, tick: int, decision: Decision) -> None:
        """Keep what the mid level decided in a tick."""
        decided = decision.mid
        if decided is None:
            return
        self._history.remember(tick, self.mid.vector, decided.rla_id)
        if decided.event is not None:
            self.passed_at_tick = tick

    def context_of(self, decision_tick: int | None) -> LessonContext:
        """The situation of a tick; None: the present one.

        Raises CommandRefusedError for one that is not remembered, or in which the robot did not know where it was.
        """
        share = self.mid.settings.learning.insert_beyond_share
        if decision_tick is None:
            newest = self._history.newest
            return _known(LessonContext(self.mid.vector, "", MID, None if newest is None else newest.rla_id, share))
        moment = self._history.get(decision_tick)
        if moment is None:
            raise CommandRefusedError(RefusalCode.TICK_FORGOTTEN, tick=decision_tick)
        return _known(LessonContext(moment.vector, "", MID, moment.rla_id, share))

    def on_lesson(self, command: Teach | Correct) -> None:
        """A lesson of the mid level was given just now: where it is about the present, it ends what went before it.

        Where another RLA on the same condition goes before the one that was taught, the robot still goes that way now.
        """
        if isinstance(command, Teach) and command.beside:
            return  # what else is possible says nothing of what is to be done
        mid = self.mid
        if not np.array_equal(self.context_of(command.decision_tick).vector, mid.vector):
            return
        match = mid.system.match(mid.vector, level=MID)
        if match is None or not match.known or match.rla.action == command.action:
            mid.end_override()
        else:
            mid.override(command.action)


def _known(meant: LessonContext) -> LessonContext:
    """Places are matched by distances, and there are none from nowhere."""
    if np.isnan(meant.vector).any():
        raise CommandRefusedError(RefusalCode.PLACE_UNKNOWN)
    return meant
