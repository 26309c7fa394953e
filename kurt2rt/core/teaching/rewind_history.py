"""Rewind history: the last seconds of driving, kept for the lessons of a teacher who looks back."""

from collections import deque
from typing import NamedTuple

from kurt2rt.core.reinforcement.decision_history import DecisionHistory

DRIVEN_TICKS = 1200
"""Ticks of driving that are kept: the ten seconds that the page offers, and what the robot drives until it stands."""
CHUNK_TICKS = 100
"""Ticks of driving that are copied at once."""


class _Stretch(NamedTuple):
    """Ticks in a row in which a wheel turned."""

    first: int
    end: int
    """Tick after the last one."""
    number: int
    """Number of the first of them, counted over all ticks of driving."""


class RewindHistory:
    """Decisions of the last 12 s of driving, however long the robot stood since, for a teacher who looks back.

    `Correct` with one of these ticks corrects that moment (rewind on the page).

    The history of recent decisions continues at standstill, so a teacher who thinks, and a robot that moves for
    moments only, would lose the drive. Memory is constant.
    """

    def __init__(self, recent: DecisionHistory) -> None:
        """Copy from `recent`, which the tick continues to write."""
        self._recent = recent
        self._kept = recent.empty_copy(DRIVEN_TICKS)
        self._stretches: deque[_Stretch] = deque()
        self._driven = 0
        """Ticks of driving up to the present stretch."""
        self._first: int | None = None
        """First tick of the present stretch that was not copied; None at standstill."""
        self.driving = False
        """Whether a wheel turned at the last update."""

    def update(self, *, driving: bool) -> None:
        """Follow the newest recent tick, in which a wheel turned if `driving`.

        Call it when that changes, and each CHUNK_TICKS ticks unless the recent history keeps all ticks.
        """
        self.driving, newest = driving, self._recent.newest
        if self._first is not None and newest > self._first:
            self._keep(self._first, newest)
        self._first = newest if driving else None

    def find(self, tick: int) -> tuple[DecisionHistory, int] | None:
        """Return the history that stores a tick, and the number by which it is read there; None if none does."""
        if self._recent.contains(tick):
            return self._recent, tick
        stretches = [*self._stretches]
        if self._first is not None:
            stretches.append(_Stretch(self._first, self._recent.newest + 1, self._driven))
        for stretch in reversed(stretches):
            if stretch.first <= tick < stretch.end:
                newest = stretches[-1].number + stretches[-1].end - stretches[-1].first
                number = stretch.number + tick - stretch.first
                read = self._kept.number_of(tick, number) if newest - number <= DRIVEN_TICKS else None
                return None if read is None else (self._kept, read)
        return None

    def _keep(self, first: int, end: int) -> None:
        """Copy the ticks of driving from `first` to before `end`, and forget the oldest ones."""
        self._kept.copy_ticks(self._recent, first, end - first, self._driven)
        self._stretches.append(_Stretch(first, end, self._driven))
        self._driven += end - first
        while self._driven - (oldest := self._stretches[0]).number - (oldest.end - oldest.first) > DRIVEN_TICKS:
            self._stretches.popleft()
