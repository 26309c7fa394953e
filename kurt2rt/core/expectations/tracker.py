"""Expectations of all driving levels: learned and compared in each tick, saved with the statistics."""

from collections.abc import Mapping
from itertools import chain

import numpy as np
from numpy.typing import NDArray

from kurt2rt.core.decision.decision import Decision, DecisionCause, MidDecision
from kurt2rt.core.expectations.expectations import End, Expectations, Surprise, affected_rla
from kurt2rt.core.mid.mid_level import MidLevel
from kurt2rt.core.perception.perception import Situation
from kurt2rt.core.rla.condition import Space
from kurt2rt.core.rla.events import RlaCreated, TeachingEvent
from kurt2rt.core.rla.rla import BASIC, MID
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.core.rla.statistics import Expectation

_NOTHING = np.zeros(0)


class BasicTransitionTracker:
    """Tracker of the driving RLA. Standstill and a change of behaviour end it without a follow-up."""

    def __init__(self, expectations: Expectations) -> None:
        self.expectations = expectations
        self._driver: int | None = None
        self._image = ""
        self._behaviour = ""
        self._since_tick = 0

    def update(
        self, tick: int, rla_id: int | None, situation: NDArray[np.float64], behaviour: str, image: str = ""
    ) -> Surprise | None:
        """Learn the expectation of the RLA that drove before, if another RLA takes over in this tick.

        Call this on every tick. After a standstill or a change of behaviour nothing is learned. Returns the surprise of
        the situation, also a small one; None if nothing was learned or too few ends were known.

        Args:
            tick: number of this tick.
            rla_id: driving RLA; None at standstill.
            situation: situation of this tick, shape (d,).
            behaviour: selected taught behaviour.
            image: in which the driving RLA answers; its end is learned as it would be where it was taught.
        """
        before_in, self._image = self._image, image
        if rla_id == self._driver:
            return None
        before, since_tick, same = self._driver, self._since_tick, behaviour == self._behaviour
        self._driver, self._since_tick, self._behaviour = rla_id, tick, behaviour
        if before is None or rla_id is None or not same:
            return None
        if before_in:
            situation = self.expectations.as_taught(situation, before_in)
        return self.expectations.learn(End(before, rla_id, situation, tick - since_tick))

    def restart(self) -> None:
        """Forget the driving RLA: the next one is no follow-up."""
        self._driver = None

    def forget(self, rla_id: int) -> None:
        """Drop the expectation of an RLA whose action was changed."""
        self.expectations.forget(rla_id)
        if rla_id == self._driver:
            self.restart()


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

    def forget(self, rla_id: int) -> None:
        """Drop the expectation of an RLA whose action was changed."""
        self.expectations.forget(rla_id)
        if rla_id in (self._commander, self._before):
            self.restart()


class ExpectationTracker:
    """Expectations of the basic level and of the optional mid level."""

    def __init__(
        self,
        system: RlaSystem,
        mid: MidLevel | None,
        transitions: Mapping[tuple[int, int], int],
        saved: Mapping[int, Expectation] | None = None,
    ) -> None:
        """Restore saved expectations; those of levels that do not drive here are kept for the next snapshot.

        `transitions`: (RLA id, follow-up id) -> count, without this tick's.
        """
        self._system = system
        self._mid = mid
        basic = Space(system.dimensions, system.radius, system.weights)
        self._basic = BasicTransitionTracker(Expectations(BASIC, system, basic, transitions, saved))
        self._mid_transitions = (
            None
            if mid is None
            else MidTransitionTracker(Expectations(MID, system, mid.settings.space, transitions, saved))
        )
        self._levels = {BASIC: self._basic.expectations}
        if self._mid_transitions is not None:
            self._levels[MID] = self._mid_transitions.expectations
        self._others = {rla_id: each for rla_id, each in (saved or {}).items() if self._is_elsewhere(rla_id)}

    def update(
        self,
        tick: int,
        decision: Decision,
        situation: Situation,
        behaviour: str,
        *,
        driving: bool,
        slow: bool = False,
        counts: bool = True,
    ) -> Surprise | None:
        """Learn from one tick before its transition is counted; return the surprise, the mid level's first.

        Call this on every tick. Returns None if no RLA ended or too few ends were known.

        Args:
            tick: number of the tick.
            decision: of the tick.
            situation: of the tick.
            behaviour: active taught behaviour.
            driving: whether the wheels turned.
            slow: whether they were slowed by a slow lesson. The basic level learns nothing then, because where and when
                one of its RLAs ends depends on the speed.
            counts: whether the tick counts on the clock of the way, by which the mid level learns how long a way is.
        """
        drove = driving and not slow
        rla_id = decision.rla_id if drove else None
        surprise = self.follow(tick, rla_id, situation.vector, behaviour, decision.image)
        following, mid, commanded = self._mid_transitions, self._mid, decision.mid
        if following is None or mid is None or commanded is None:
            return surprise
        if commanded.overridden or decision.cause is DecisionCause.TEACHER:
            following.restart()
        return following.update(commanded, mid.vector, driving=driving and counts) or surprise

    def follow(
        self, tick: int, rla_id: int | None, vector: NDArray[np.float64], behaviour: str, image: str
    ) -> Surprise | None:
        """Learn at the basic level from one tick; ticks in which the same RLA drives on may be left out.

        Args:
            tick: number of the tick.
            rla_id: RLA that drove at full speed; None at standstill.
            vector: situation of the basic level, (d,).
            behaviour: active taught behaviour.
            image: in which the RLA drove; empty for none.
        """
        return self._basic.update(tick, rla_id, vector, behaviour, image)

    def on_event(self, event: TeachingEvent) -> int | None:
        """Drop the expectation of the RLA whose action an applied event changed.

        Returns its id, because its counted transitions are invalid too; None for new RLAs and other events.
        """
        changed = affected_rla(event, self._system.history)
        if changed is None:
            return None
        self._basic.forget(changed)
        if self._mid_transitions is not None:
            self._mid_transitions.forget(changed)
        return None if isinstance(event, RlaCreated) else changed

    def restart(self) -> None:
        """Forget the driving RLAs after the robot was repositioned: the next RLA is no follow-up."""
        self._basic.restart()
        if self._mid_transitions is not None:
            self._mid_transitions.restart()

    def get(self, rla_id: int) -> Expectation | None:
        """Return the expectation of an RLA; None before its first end, and for levels that do not drive."""
        rla = self._system.get(rla_id)
        expectations = None if rla is None else self._levels.get(rla.level)
        return None if expectations is None else expectations.get(rla_id)

    def snapshot(self) -> dict[int, Expectation]:
        """Return all expectations of both levels by RLA id; unchanged ones are the same objects as before."""
        kept = {rla_id: each for rla_id, each in self._others.items() if self._is_elsewhere(rla_id)}
        return dict(chain(kept.items(), *(each.snapshot().items() for each in self._levels.values())))

    def _is_elsewhere(self, rla_id: int) -> bool:
        rla = self._system.get(rla_id)
        return rla is not None and rla.level not in self._levels
