"""Lessons of the mid level, and a teacher's commands in its place."""

from bisect import bisect_right
from collections import deque
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kurt2rt.core.decision.decision import Decision
from kurt2rt.core.mid.mid_level import MidLevel
from kurt2rt.core.outcome import CommandRefusedError, RefusalCode
from kurt2rt.core.rla.rla import MID
from kurt2rt.core.teaching.commands import Correct, Teach
from kurt2rt.core.teaching.lesson_result import LessonContext


class MidSnapshot(NamedTuple):
    """Situation and decision of the mid level, which stay equal from junction to junction."""

    vector: NDArray[np.float64]
    """Mid-level situation, shape (d,)."""
    rla_id: int | None
    """Mid-level RLA that commanded; None if the level asked or a teacher commanded."""


class MidHistory:
    """Last `capacity` snapshots by tick, because a teacher may mean a junction of minutes ago."""

    def __init__(self, capacity: int = 64) -> None:
        self._first_ticks: deque[int] = deque(maxlen=capacity)
        self._snapshots: deque[MidSnapshot] = deque(maxlen=capacity)
        self._newest = -1

    def remember(self, tick: int, vector: NDArray[np.float64], rla_id: int | None) -> None:
        """Add the snapshot of a tick; the oldest is dropped.

        Args:
            tick: number of the tick.
            vector: mid-level situation, shape (d,). It is stored without a copy and must never change: an identical
                object is the same situation.
            rla_id: RLA that commanded; None if the level asked or a teacher commanded.
        """
        self._newest = tick
        if self._snapshots:
            last = self._snapshots[-1]
            if last.vector is vector and last.rla_id == rla_id:
                return
        self._first_ticks.append(tick)
        self._snapshots.append(MidSnapshot(vector, rla_id))

    @property
    def newest(self) -> MidSnapshot | None:
        """Newest snapshot; None before the first."""
        return self._snapshots[-1] if self._snapshots else None

    def get(self, tick: int) -> MidSnapshot | None:
        """Return the snapshot of a tick; None if it was dropped or is in the future."""
        place = bisect_right(self._first_ticks, tick) - 1 if tick <= self._newest else -1
        return self._snapshots[place] if place >= 0 else None


class MidLessons:
    """History of the mid level for lessons on past decisions, and its override by a teacher."""

    def __init__(self, mid: MidLevel) -> None:
        self.mid = mid
        self.passed_at_tick = -1
        """Tick in which the last junction was passed; commands on older states are about that junction."""
        self._history = MidHistory()

    def remember(self, tick: int, decision: Decision) -> None:
        """Add the mid level's decision of a tick to the history; call it after each decision."""
        decided = decision.mid
        if decided is None:
            return
        self._history.remember(tick, self.mid.vector, decided.rla_id)
        if decided.event is not None:
            self.passed_at_tick = tick

    def context_of(self, decision_tick: int | None) -> LessonContext:
        """Return the context of a lesson about a tick; None: about the present.

        Raises:
            CommandRefusedError: if the tick was forgotten, or the robot did not know its place then.
        """
        share = self.mid.settings.learning.insert_radius_fraction
        if decision_tick is None:
            newest = self._history.newest
            return _known(LessonContext(self.mid.vector, "", MID, None if newest is None else newest.rla_id, share))
        moment = self._history.get(decision_tick)
        if moment is None:
            raise CommandRefusedError(RefusalCode.TICK_FORGOTTEN, tick=decision_tick)
        return _known(LessonContext(moment.vector, "", MID, moment.rla_id, share))

    def on_lesson(self, command: Teach | Correct) -> None:
        """Let a new lesson about the present situation replace the teacher's override.

        If another RLA on the same condition wins against the taught one, override the level by the taught action.
        Raises CommandRefusedError if the command's tick was forgotten.
        """
        if isinstance(command, Teach) and command.alternative:
            return  # an alternative does not change the present command
        mid = self.mid
        if not np.array_equal(self.context_of(command.decision_tick).vector, mid.vector):
            return
        match = mid.system.match(mid.vector, level=MID)
        if match is None or not match.known or match.rla.action == command.action:
            mid.end_override()
        else:
            mid.override(command.action)


def _known(context: LessonContext) -> LessonContext:
    """Return the context; raise CommandRefusedError if its place is unknown, because it has no distances."""
    if np.isnan(context.vector).any():
        raise CommandRefusedError(RefusalCode.PLACE_UNKNOWN)
    return context
