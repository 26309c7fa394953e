"""The latest decisions, so that a teacher can mean one of them: delay must not blur who is blamed."""

import numpy as np
from numpy.typing import NDArray

from kurt2rt.layers.decision import Decision
from kurt2rt.perception.perception import Situation


class RecentDecisions:
    """Situation, deciding RLA and wanted behaviour of the last `capacity` ticks, in memory that does not grow."""

    def __init__(self, dimensions: int, capacity: int = 1000) -> None:
        self._capacity = capacity
        self._ticks = np.full(capacity, -1, dtype=np.int64)
        # Written once here: memory that is only promised costs the first tick that touches it half a millisecond.
        self._situations = np.full((capacity, dimensions), np.nan)
        self._seeing = np.zeros(capacity, dtype=np.bool_)
        self._rlas: list[int | None] = [None] * capacity
        self._behaviours = [""] * capacity
        self.newest = -1
        """Tick of the newest decision; -1 before the first."""

    def remember(
        self, tick: int, situation: Situation, decision: Decision, behaviour: str = "", *, blind: bool
    ) -> None:
        """Keep what was decided in a tick, and for which taught behaviour; the oldest is forgotten.

        A `blind` robot was in no situation.
        """
        row = tick % self._capacity
        self.newest = tick
        self._ticks[row] = tick
        self._seeing[row] = not blind
        self._situations[row] = situation.vector
        self._rlas[row] = decision.rla_id
        self._behaviours[row] = behaviour

    def knows(self, tick: int) -> bool:
        """Whether that tick is kept: it ran, and not too long ago."""
        return tick >= 0 and int(self._ticks[tick % self._capacity]) == tick

    def saw(self, tick: int) -> bool:
        """Whether the robot saw anything in a tick that is known."""
        return bool(self._seeing[tick % self._capacity])

    def situation(self, tick: int) -> NDArray[np.float64]:
        """Situation vector (d,) of a tick that is known and seen; a view, to be copied by whoever keeps it."""
        row: NDArray[np.float64] = self._situations[tick % self._capacity]
        return row

    def rla(self, tick: int) -> int | None:
        """The RLA that drove in a tick that is known."""
        return self._rlas[tick % self._capacity]

    def behaviour(self, tick: int) -> str:
        """The taught behaviour that was wanted in a tick that is known."""
        return self._behaviours[tick % self._capacity]
