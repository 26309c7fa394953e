"""History of decisions, so that a delayed reward or correction meets the decision that it is about."""

import numpy as np
from numpy.typing import NDArray

from behaviors.judges.judge import AppraisalFeatures
from kurt2rt.core.critic.critic import Opinion
from kurt2rt.core.decision.decision import Decision, DecisionCause
from kurt2rt.core.perception.perception import Situation

_LEARNER = DecisionCause.LEARNER
"""Name for each tick, because Python 3.11 looks a member up in its enumeration ten times slower than a global."""


class DecisionHistory:
    """Memory of the last `capacity` ticks, about which teachers reward, correct and appraise.

    It holds situations, decisions and opinions, in constant memory.
    """

    def __init__(self, dimensions: int, capacity: int = 1000) -> None:
        self._capacity = capacity
        self._ticks = np.full(capacity, -1, dtype=np.int64)
        # Filled here: the first write to a page of untouched memory would cost a tick half a millisecond.
        self._situations = np.full((capacity, dimensions), np.nan)
        # Lists, because an item of an array takes a tick five to ten times as long to set.
        self._has_situation = [False] * capacity
        self._touches = [False] * capacity
        self._teachable = [False] * capacity
        self._slow = [False] * capacity
        self._rlas: list[int | None] = [None] * capacity
        self._learner_actions = [""] * capacity
        self._behaviours = [""] * capacity
        self._answering = np.zeros(capacity, dtype=np.int64)
        self._circumstances: list[AppraisalFeatures | None] = [None] * capacity
        self._opinions: list[Opinion | None] = [None] * capacity
        self.newest = -1
        """Tick of the newest decision; -1 before the first one."""

    def add(
        self,
        tick: int,
        situation: Situation | None,
        decision: Decision,
        behaviour: str = "",
        *,
        touches: bool = False,
        teachable: bool = True,
        slow: bool = False,
        circumstances: AppraisalFeatures | None = None,
        opinion: Opinion | None = None,
    ) -> None:
        """Store a tick instead of the oldest one.

        Args:
            tick: number of the tick.
            situation: its situation; None without sensor data.
            decision: its decision.
            behaviour: active taught behaviour.
            touches: whether the robot asked at a bumper instead of driving.
            teachable: whether a held action may become a lesson about it: an RLA or a hold drove, or the robot asked.
            slow: whether the wheels were slowed by a slow lesson; no reward is about such a tick.
            circumstances: appraisal features; None without a critic or situation.
            opinion: critic's opinion; None without one.
        """
        row = tick % self._capacity
        self.newest = tick
        self._ticks[row] = tick
        has_situation = self._has_situation[row] = situation is not None
        if situation is not None:
            self._situations[row] = situation.vector
        self._touches[row] = touches
        self._teachable[row] = teachable and has_situation
        self._slow[row] = slow
        rla_id = self._rlas[row] = decision.rla_id
        self._learner_actions[row] = decision.action or "" if decision.cause is _LEARNER else ""
        self._behaviours[row] = behaviour
        self._answering[row] = rla_id if rla_id is not None and decision.answers and not slow else 0
        self._circumstances[row] = circumstances
        self._opinions[row] = opinion

    def empty_copy(self, capacity: int) -> "DecisionHistory":
        """Return an empty history of the last `capacity` ticks, with the same dimensions."""
        return DecisionHistory(self._situations.shape[1], capacity)

    def copy_ticks(self, other: "DecisionHistory", first: int, count: int, number: int) -> None:
        """Store `count` ticks of another history, from `first` on, with the numbers `number`, `number` + 1 and so on.

        Only situations, behaviours, RLAs and touches are copied, in slices: no arrays are allocated.
        """
        while count:
            source, target = first % other._capacity, number % self._capacity
            length = min(count, other._capacity - source, self._capacity - target)
            rows, to = slice(source, source + length), slice(target, target + length)
            # A tick that the other history missed keeps a number that is none of these.
            self._ticks[to] = other._ticks[rows]
            self._ticks[to] += number - first
            self._situations[to] = other._situations[rows]
            self._has_situation[to] = other._has_situation[rows]
            self._touches[to] = other._touches[rows]
            self._rlas[to] = other._rlas[rows]
            self._behaviours[to] = other._behaviours[rows]
            first, number, count = first + length, number + length, count - length

    def number_of(self, tick: int, number: int) -> int | None:
        """Return the number by which a tick can be read that was copied with this `number`; None if it was missed."""
        del tick
        return number if self.contains(number) else None

    def contains(self, tick: int) -> bool:
        """Return whether a tick is stored; ask before reading anything of a tick."""
        return tick >= 0 and int(self._ticks[tick % self._capacity]) == tick

    def has_situation(self, tick: int) -> bool:
        """Return whether a stored tick had sensor data."""
        return self._has_situation[tick % self._capacity]

    def teachable(self, tick: int) -> bool:
        """Return whether a held action may become a lesson about a stored tick."""
        return self._teachable[tick % self._capacity]

    def slow(self, tick: int) -> bool:
        """Return whether a stored tick was part of a slow lesson."""
        return self._slow[tick % self._capacity]

    def touched(self, tick: int) -> bool:
        """Return whether the robot asked at a bumper in a stored tick."""
        return self._touches[tick % self._capacity]

    def situation(self, tick: int) -> NDArray[np.float64]:
        """Return the situation (d,) of a stored tick that had one: a view that later ticks overwrite."""
        row: NDArray[np.float64] = self._situations[tick % self._capacity]
        return row

    def driving_rla(self, tick: int) -> int | None:
        """Return the id of the RLA that drove in a stored tick; None if none did."""
        return self._rlas[tick % self._capacity]

    def drove(self, tick: int) -> bool:
        """Return whether an RLA or another learner drove in a stored tick."""
        return self.driving_rla(tick) is not None or bool(self.learner_action(tick))

    def learner_action(self, tick: int) -> str:
        """Return the action by which a learner that is no RLA system drove in a stored tick; empty if none did."""
        return self._learner_actions[tick % self._capacity]

    def behaviour(self, tick: int) -> str:
        """Return the active taught behaviour of a stored tick."""
        return self._behaviours[tick % self._capacity]

    def answering_rla(self, tick: int) -> int | None:
        """Return the id of the RLA that drove in a stored tick inside its radius at full speed; None if none did.

        Rewards are about this RLA.
        """
        return int(self._answering[tick % self._capacity]) or None

    def answering_up_to(self, tick: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return the stored ticks up to `tick`, oldest first, and the ids of their answering RLAs, both (n,).

        The id is 0 if no RLA answered in a tick.
        """
        ticks = np.arange(max(0, tick - self._capacity + 1), tick + 1)
        rows = ticks % self._capacity
        kept = self._ticks[rows] == ticks
        return ticks[kept], self._answering[rows[kept]]

    def circumstances(self, tick: int) -> AppraisalFeatures | None:
        """Return the appraisal features of a stored tick; None without sensor data or critic."""
        return self._circumstances[tick % self._capacity]

    def opinion(self, tick: int) -> Opinion | None:
        """Return the critic's opinion of a stored tick; None without an opinion or critic."""
        return self._opinions[tick % self._capacity]
