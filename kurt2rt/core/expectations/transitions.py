"""Detection of the end of an RLA: per tick at the basic level, per junction at the mid level."""

import numpy as np
from numpy.typing import NDArray

from kurt2rt.core.decision.decision import MidDecision
from kurt2rt.core.expectations.expectations import End, Expectations
from kurt2rt.core.expectations.surprise import Surprise
from kurt2rt.core.rla.events import TeachingEvent

_NOTHING = np.zeros(0)


class BasicTransitionTracker:
    """Tracker of the driving RLA. Standstill and a change of behaviour end it without a follow-up."""

    def __init__(self, expectations: Expectations) -> None:
        self.expectations = expectations
        self._driver: int | None = None
        self._behaviour = ""
        self._since_tick = 0

    def update(self, tick: int, rla_id: int | None, situation: NDArray[np.float64], behaviour: str) -> Surprise | None:
        """Learn the expectation of the RLA that drove before, if another RLA takes over in this tick.

        Call this on every tick. After a standstill or a change of behaviour nothing is learned. Returns the surprise of
        the situation, also a small one; None if nothing was learned or too few ends were known.

        Args:
            tick: number of this tick.
            rla_id: driving RLA; None at standstill.
            situation: situation of this tick, shape (d,).
            behaviour: selected taught behaviour.
        """
        if rla_id == self._driver:
            return None
        before, since_tick, same = self._driver, self._since_tick, behaviour == self._behaviour
        self._driver, self._since_tick, self._behaviour = rla_id, tick, behaviour
        if before is None or rla_id is None or not same:
            return None
        return self.expectations.learn(End(before, rla_id, situation, tick - since_tick))

    def restart(self) -> None:
        """Forget the driving RLA: the next one is no follow-up."""
        self._driver = None

    def on_event(self, event: TeachingEvent) -> int | None:
        """Drop the expectation of the basic RLA whose action an applied event changed.

        Returns the id of that RLA; None if the event changes no action.
        """
        changed = self.expectations.on_event(event)
        if changed is not None and changed == self._driver:
            self.restart()
        return changed


class MidTransitionTracker:
    """Tracker of the commanding RLA, which ends at each change of the mid-level situation.

    Other changes (a lesson, a new goal, an override) are no consequence of its command. If the next situation is
    unknown, the RLA that is taught there is the follow-up.
    """

    def __init__(self, expectations: Expectations) -> None:
        self.expectations = expectations
        self._commander: int | None = None
        self._situation: NDArray[np.float64] = _NOTHING
        self._driven_ticks = 0
        self._before: int | None = None
        """RLA that led here, until the follow-up is known."""
        self._before_ticks = 0

    def update(self, mid: MidDecision, situation: NDArray[np.float64], *, driving: bool) -> Surprise | None:
        """Learn the expectation of the RLA that commanded before, once the situation has changed.

        Call this on every tick. An RLA under whose command the wheels never turned learns nothing. Returns the
        surprise, also a small one; None if nothing was learned or too few ends were known.

        Args:
            mid: decision of the mid level in this tick.
            situation: shape (d,). Pass the same array object until it changes: identity is compared, not the values.
            driving: whether the wheels turned.
        """
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
        """Forget the commanding RLA after repositioning or manual driving."""
        self._commander = self._before = None
        self._driven_ticks = 0

    def on_event(self, event: TeachingEvent) -> int | None:
        """Drop the expectation of the mid-level RLA whose action an applied event changed.

        Returns the id of that RLA; None if the event changes no action.
        """
        changed = self.expectations.on_event(event)
        if changed is not None and changed in (self._commander, self._before):
            self.restart()
        return changed
