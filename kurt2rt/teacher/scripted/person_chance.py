"""Chance of a scripted person: delays, lapses, slips and misjudged moments, each from a random stream of its own."""

import random

from kurt2rt.core.teacher_settings import Delay, PersonSettings
from kurt2rt.teacher.scripted.human_limits import AttentionLapses, DelaySampler
from kurt2rt.teacher.scripted.look_back import LookBack, Mistake


class PersonChance:
    """All chance of a person: one random stream for each kind of event."""

    def __init__(self, person: PersonSettings, period_s: float, of: str) -> None:
        """Begin the streams; `of` tells them from those of another lesson."""

        def delays(delay: Delay, name: str) -> DelaySampler:
            return DelaySampler(delay, person.slower_per_minute, period_s, name + of)

        self.question_delay = delays(person.question_delay, "question delays")
        self.mistake_delay = delays(person.mistake_delay, "mistake delays")
        self._look_back_delay = delays(person.look_back.takes, "looks back")
        self.attention = AttentionLapses(person.lapses, period_s, "lapses" + of)
        self.errors = random.Random("errors" + of)
        self.slips = random.Random("slips that are noticed" + of)
        self._moments = random.Random("moments of mistakes" + of)
        self._moment_spread = person.look_back.moment_spread_s / period_s
        self._period_s = period_s

    def look_back(self, mistake: Mistake) -> LookBack:
        """Return the correction of a mistake by rewind."""
        return LookBack(mistake, self._look_back_delay, self._period_s)

    def moment_error_ticks(self) -> int:
        """Return the error of the moment that the person takes for the begin of a mistake."""
        return round(self._moments.gauss(0.0, self._moment_spread))
