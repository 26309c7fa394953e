"""Several taught behaviours in turn, as a teacher wants them who does not see the streets."""

from collections.abc import Sequence

from kurt2rt.channel.protocol.state import State

EACH_S = 30.0
"""A behaviour is wanted for so long: the way to a junction or two, and through."""
_SAY_AGAIN_S = 1.0


class BehaviourCycler:
    """Which behaviour is wanted now, and when to tell the robot; of a task with one there is nothing to tell."""

    def __init__(self, behaviours: Sequence[str], period_s: float) -> None:
        """The first one is what the robot follows when it is seen first; `period_s`: of its ticks."""
        self.wanted: str | None = None
        """None before the first picture."""
        self._behaviours = tuple(behaviours)
        self._each_ticks = round(EACH_S / period_s)
        self._again_ticks = round(_SAY_AGAIN_S / period_s)
        self._since = self._tick = 0
        self._said_at: int | None = None

    def see(self, state: State, *, stopped: bool) -> bool:
        """See a picture; whether `wanted` is to be told now, again a second after it was not heard or was refused.

        `stopped`: somebody has stopped the robot. He is told nothing of behaviours, and none loses time by it.
        """
        if self.wanted is None:
            self.wanted = state.behaviour if state.behaviour in self._behaviours else self._behaviours[0]
            self._tick = state.tick
        passed, self._tick = state.tick - self._tick, state.tick
        if stopped:
            return False
        self._since += passed
        if self._since >= self._each_ticks:
            self._since = 0
            self._said_at = None
            self.wanted = self._behaviours[(self._behaviours.index(self.wanted) + 1) % len(self._behaviours)]
        if state.behaviour == self.wanted:
            return False
        if self._said_at is not None and state.tick < self._said_at + self._again_ticks:
            return False
        self._said_at = state.tick
        return True
