"""Notices when an RLA has ended of itself: from tick to tick at the basic level, from junction to junction at mid."""

import numpy as np
from numpy.typing import NDArray

from kurt2rt.core.decision.decision import MidDecision
from kurt2rt.core.expectations.expectations import End, Expectations
from kurt2rt.core.expectations.surprise import Surprise
from kurt2rt.core.rla.rla import TeachingEvent

_NOTHING = np.zeros(0)


class BasicTransitionTracker:
    """Follows the RLA that drives. Standstill, and another behaviour that is wanted, end it without a follow-up."""

    def __init__(self, expectations: Expectations) -> None:
        self.expectations = expectations
        self._driver: int | None = None
        self._behaviour = ""
        self._since_tick = 0

    def update(self, tick: int, rla_id: int | None, situation: NDArray[np.float64], behaviour: str) -> Surprise | None:
        """Take in one tick: the RLA that drives, None while the robot stands; `situation`: vector (d,)."""
        if rla_id == self._driver:
            return None
        before, since_tick, same = self._driver, self._since_tick, behaviour == self._behaviour
        self._driver, self._since_tick, self._behaviour = rla_id, tick, behaviour
        if before is None or rla_id is None or not same:
            return None
        return self.expectations.learn(End(before, rla_id, situation, tick - since_tick))

    def restart(self) -> None:
        """What comes now follows from nothing: the robot was set down elsewhere."""
        self._driver = None

    def on_event(self, event: TeachingEvent) -> int | None:
        """As `Expectations.hear`."""
        changed = self.expectations.on_event(event)
        if changed is not None and changed == self._driver:
            self.restart()
        return changed


class MidTransitionTracker:
    """Follows the RLA that commands. It ends where the mid-level situation becomes another, also if it goes on itself.

    What else changes it (a lesson, another goal, the teacher's word) is no consequence of what it commanded. Where
    nobody knew the situation that it led to, the RLA that is taught there is what followed.
    """

    def __init__(self, expectations: Expectations) -> None:
        self.expectations = expectations
        self._commander: int | None = None
        self._situation: NDArray[np.float64] = _NOTHING
        self._driven_ticks = 0
        self._before: int | None = None
        """The one that led here, while nobody knows this situation."""
        self._before_ticks = 0

    def update(self, mid: MidDecision, situation: NDArray[np.float64], *, driving: bool) -> Surprise | None:
        """Take in one tick. `situation`: a new array (d,) whenever it becomes another; `driving`: whether it drove."""
        rla_id = mid.rla_id
        if situation is self._situation:
            if rla_id == self._commander:
                self._driven_ticks += driving
                return None
        else:
            self._situation = situation
            self._before = self._commander if self._driven_ticks else None
            self._before_ticks = self._driven_ticks
        self._commander = rla_id
        self._driven_ticks = int(driving)
        before = self._before
        if before is None or rla_id is None:
            return None
        self._before = None
        return self.expectations.learn(End(before, rla_id, situation, self._before_ticks))

    def restart(self) -> None:
        """What comes now follows from nothing: the robot was set down elsewhere, or driven by hand."""
        self._commander = self._before = None
        self._driven_ticks = 0

    def on_event(self, event: TeachingEvent) -> int | None:
        """As `Expectations.hear`."""
        changed = self.expectations.on_event(event)
        if changed is not None and changed in (self._commander, self._before):
            self.restart()
        return changed
