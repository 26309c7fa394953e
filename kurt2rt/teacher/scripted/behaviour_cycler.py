"""Cycle through a task's behaviours, 30 s each, for a scripted teacher without a map."""

from collections.abc import Sequence

from kurt2rt.channel.protocol.state import State

EACH_S = 30.0
"""Time for each behaviour: enough for one or two junctions."""
_REPEAT_S = 1.0


class BehaviourCycler:
    """Selection of one behaviour after another; a task of one behaviour needs no command."""

    def __init__(self, behaviours: Sequence[str], period_s: float) -> None:
        """Start with the behaviour that the robot follows in the first state; `period_s` is the length of a tick."""
        self.selected: str | None = None
        """None before the first state."""
        self._behaviours = tuple(behaviours)
        self._each_ticks = round(EACH_S / period_s)
        self._repeat_ticks = round(_REPEAT_S / period_s)
        self._elapsed = self._tick = 0
        self._commanded_at: int | None = None

    def update(self, state: State, *, stopped: bool) -> bool:
        """Take a state; return whether to command `selected` now.

        A command that was lost or refused is due again after a second. No time passes while a person has `stopped` the
        robot.
        """
        if self.selected is None:
            self.selected = state.behaviour if state.behaviour in self._behaviours else self._behaviours[0]
            self._tick = state.tick
        passed, self._tick = state.tick - self._tick, state.tick
        if stopped:
            return False
        self._elapsed += passed
        if self._elapsed >= self._each_ticks:
            self._elapsed = 0
            self._commanded_at = None
            self.selected = self._behaviours[(self._behaviours.index(self.selected) + 1) % len(self._behaviours)]
        if state.behaviour == self.selected:
            return False
        if self._commanded_at is not None and state.tick < self._commanded_at + self._repeat_ticks:
            return False
        self._commanded_at = state.tick
        return True
