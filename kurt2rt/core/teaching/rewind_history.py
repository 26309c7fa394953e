"""Rewind history: decisions before a standstill, kept for the lessons of a teacher who looks back."""

from kurt2rt.core.reinforcement.decision_history import DecisionHistory


class RewindHistory:
    """Recent decisions, and those of the last 1000 ticks before the newest standstill.

    The history of recent decisions continues at standstill, so a teacher who stops the robot and looks back would lose
    ten seconds of driving after ten seconds of thought. The copy is made once a standstill, in constant memory.
    """

    def __init__(self, recent: DecisionHistory) -> None:
        """Copy from `recent`, which the tick continues to write."""
        self._recent = recent
        self._before_standstill = recent.empty_copy()
        self.was_driving = False
        """Whether the robot drove at the last update."""

    def update(self, *, driving: bool) -> None:
        """Copy the recent decisions if the robot drove before and does not now; call it when `driving` changes."""
        if self.was_driving and not driving:
            self._before_standstill.copy_from(self._recent)
        self.was_driving = driving

    def find(self, tick: int) -> DecisionHistory | None:
        """Return the history that stores a tick; None if neither does."""
        if self._recent.contains(tick):
            return self._recent
        return self._before_standstill if self._before_standstill.contains(tick) else None
