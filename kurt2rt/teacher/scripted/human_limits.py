"""Limits of a person who teaches: reaction times, lapses of attention, presses a minute, noticing of mistakes."""

import random
from collections import deque
from collections.abc import Mapping

from kurt2rt.core.teacher_settings import Delay, LapseSettings, NoticeSettings
from kurt2rt.teacher.scripted.basic_teacher import TeacherView

MINUTE_S = 60.0


class DelaySampler:
    """Delays in ticks, one drawn for each event; they grow with the time of teaching."""

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


class Attention:
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
    """Limit on presses in any minute."""

    def __init__(self, presses_per_minute: int, period_s: float) -> None:
        """Allow so many presses in any 60 s; 0: no limit."""
        self._limit = presses_per_minute
        self._minute_ticks = round(MINUTE_S / period_s)
        self._presses: deque[int] = deque(maxlen=presses_per_minute or 1)

    def allows(self, now: int) -> bool:
        """Return whether a press in tick `now` stays within the limit."""
        if not self._limit or len(self._presses) < self._limit:
            return True
        return now - self._presses[0] >= self._minute_ticks

    def count(self, now: int) -> None:
        """Count a press."""
        self._presses.append(now)


class MistakeWatcher:
    """Detector of mistakes that a person can see: of other actions that look different, or that last."""

    def __init__(self, settings: NoticeSettings, groups: Mapping[str, str], period_s: float) -> None:
        """Watch with these `groups` of actions that look alike; an action without a group is one of its own."""
        self._different_ticks = round(settings.different_after_s / period_s)
        self._similar_ticks = round(settings.similar_after_s / period_s)
        self._groups = groups
        self.began: TeacherView | None = None
        """State in which the present disagreement began; None without disagreement."""
        self._last_tick = 0
        self._wrong = self._looked_wrong = 0

    def update(self, view: TeacherView, right: str) -> bool:
        """Take a state of a driving robot with its right action; return whether a mistake is noticed now."""
        if view.action is None or view.action == right:
            self.reset()
            return False
        if self.began is None:
            self.began, self._last_tick = view, view.tick
        elapsed, self._last_tick = view.tick - self._last_tick, view.tick
        self._wrong += elapsed
        if self._groups.get(view.action, view.action) != self._groups.get(right, right):
            self._looked_wrong += elapsed
        return self._looked_wrong >= max(self._different_ticks, 1) or self._wrong >= max(self._similar_ticks, 1)

    def reset(self) -> None:
        """Forget the present disagreement."""
        self.began = None
        self._wrong = self._looked_wrong = 0
