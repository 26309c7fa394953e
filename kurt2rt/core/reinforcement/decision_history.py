"""The latest decisions, so that a teacher can mean one of them: delay must not blur who is blamed."""

import numpy as np
from numpy.typing import NDArray

from behaviors.judges.judge import AppraisalFeatures
from kurt2rt.core.critic.critic import Opinion
from kurt2rt.core.decision.decision import Decision
from kurt2rt.core.perception.perception import Situation


class DecisionHistory:
    """What was seen, decided and thought in the last `capacity` ticks, in memory that does not grow."""

    def __init__(self, dimensions: int, capacity: int = 1000) -> None:
        self._capacity = capacity
        self._ticks = np.full(capacity, -1, dtype=np.int64)
        # Written once here: memory that is only promised costs the first tick that touches it half a millisecond.
        self._situations = np.full((capacity, dimensions), np.nan)
        self._has_situation = np.zeros(capacity, dtype=np.bool_)
        self._touches = np.zeros(capacity, dtype=np.bool_)
        self._rlas: list[int | None] = [None] * capacity
        self._behaviours = [""] * capacity
        self._answering = np.zeros(capacity, dtype=np.int64)
        self._circumstances: list[AppraisalFeatures | None] = [None] * capacity
        self._opinions: list[Opinion | None] = [None] * capacity
        self.newest = -1
        """Tick of the newest decision; -1 before the first."""

    def add(
        self,
        tick: int,
        situation: Situation,
        decision: Decision,
        behaviour: str = "",
        *,
        blind: bool,
        touches: bool = False,
        circumstances: AppraisalFeatures | None = None,
        opinion: Opinion | None = None,
    ) -> None:
        """Keep what was decided in a tick, for which taught behaviour, and what the critic thought of it.

        The oldest is forgotten. A `blind` robot was in no situation; one that `touches` something asked what to do
        there in place of what it had decided.
        """
        row = tick % self._capacity
        self.newest = tick
        self._ticks[row] = tick
        self._has_situation[row] = not blind
        self._touches[row] = touches
        self._situations[row] = situation.vector
        self._rlas[row] = decision.rla_id
        self._behaviours[row] = behaviour
        self._answering[row] = (decision.rla_id or 0) if decision.answers else 0
        self._circumstances[row] = circumstances
        self._opinions[row] = opinion

    def contains(self, tick: int) -> bool:
        """Whether that tick is kept: it ran, and not too long ago."""
        return tick >= 0 and int(self._ticks[tick % self._capacity]) == tick

    def has_situation(self, tick: int) -> bool:
        """Whether the robot saw anything in a tick that is known."""
        return bool(self._has_situation[tick % self._capacity])

    def touched(self, tick: int) -> bool:
        """Whether the robot asked what to do with what it touched, in a tick that is known."""
        return bool(self._touches[tick % self._capacity])

    def situation(self, tick: int) -> NDArray[np.float64]:
        """Situation vector (d,) of a tick that is known and seen; a view, to be copied by whoever keeps it."""
        row: NDArray[np.float64] = self._situations[tick % self._capacity]
        return row

    def driving_rla(self, tick: int) -> int | None:
        """The RLA that drove in a tick that is known."""
        return self._rlas[tick % self._capacity]

    def behaviour(self, tick: int) -> str:
        """The taught behaviour that was wanted in a tick that is known."""
        return self._behaviours[tick % self._capacity]

    def answering_rla(self, tick: int) -> int | None:
        """The RLA that drove in a tick that is known while the situation lay inside its radius: who may be blamed."""
        return int(self._answering[tick % self._capacity]) or None

    def answering_up_to(self, tick: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """All ticks that are kept, up to and with one, oldest first, and the RLA that answered in each (0: none)."""
        ticks = np.arange(max(0, tick - self._capacity + 1), tick + 1)
        rows = ticks % self._capacity
        kept = self._ticks[rows] == ticks
        return ticks[kept], self._answering[rows[kept]]

    def circumstances(self, tick: int) -> AppraisalFeatures | None:
        """The appraisal situation of a tick that is known; None where the robot saw nothing, or has no critic."""
        return self._circumstances[tick % self._capacity]

    def opinion(self, tick: int) -> Opinion | None:
        """What the critic thought in a tick that is known; None where it had been taught nothing, or there is none."""
        return self._opinions[tick % self._capacity]
