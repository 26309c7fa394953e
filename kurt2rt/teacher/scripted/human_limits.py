"""Limits of a person who teaches: reaction times, lapses of attention, presses a minute."""

import random
from collections import deque

from kurt2rt.core.teacher_settings import Delay, LapseSettings

MINUTE_S = 60.0


class DelaySampler:
    """Source of a scripted person's delays in ticks, one for each event; they grow while it teaches."""

    def __init__(self, delay: Delay, slower_per_minute: float, period_s: float, seed: str) -> None:
        """Draw from a random stream of this `seed`, which nothing else uses; `period_s` is the length of a tick."""
        self._delay = delay
        self._slower_per_tick = slower_per_minute * period_s / MINUTE_S
        self._period_s = period_s
        self._chance = random.Random(seed)

    def draw(self, now: int) -> int:
        """Return the delay in ticks of an event in tick `now`, counted from the begin of the teaching."""
        tired = 1.0 + self._slower_per_tick * now
        return round(self._delay.draw_s(self._chance) * tired / self._period_s)


class AttentionLapses:
    """Lapses of attention: a Poisson process of their begins, each with a drawn duration."""

    def __init__(self, settings: LapseSettings, period_s: float, seed: str) -> None:
        """Draw from a random stream of this `seed`, which nothing else uses; `period_s` is the length of a tick."""
        self._settings = settings
        self._period_s = period_s
        self._chance = random.Random(seed)
        self._away_from = self._away_until = 0

    def is_on(self, now: int) -> bool:
        """Return whether the person looks at the robot in tick `now`; ticks never go back."""
        if not self._settings.per_minute:
            return True
        while now >= self._away_until:
            wait_s = self._chance.expovariate(self._settings.per_minute / MINUTE_S)
            self._away_from = self._away_until + self._ticks(wait_s)
            self._away_until = self._away_from + self._ticks(self._settings.duration.draw_s(self._chance))
        return now < self._away_from

    def _ticks(self, duration_s: float) -> int:
        return max(1, round(duration_s / self._period_s))


class PressLimit:
    """Limit on a scripted person's presses in any minute, and the clock that it counts by."""

    def __init__(self, presses_per_minute: int, period_s: float) -> None:
        """Allow so many presses in any 60 s; 0: no limit."""
        self.now = 0
        """Ticks since the begin of the teaching."""
        self._limit = presses_per_minute
        self._minute_ticks = round(MINUTE_S / period_s)
        self._presses: deque[int] = deque(maxlen=presses_per_minute or 1)

    def allows(self, presses: int = 1) -> bool:
        """Return whether so many presses now stay within the limit."""
        if self._limit and presses > self._limit:
            return False
        if not self._limit or len(self._presses) + presses <= self._limit:
            return True
        return self.now - self._presses[len(self._presses) + presses - self._limit - 1] >= self._minute_ticks

    def count(self) -> None:
        """Count a press of this tick."""
        self._presses.append(self.now)
