"""The internal critic: an RLA system whose actions are opinions (paper, phase 4)."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from behaviors.judges.judge import AppraisalFeatures
from kurt2rt.core.critic.settings import AppraisalSettings, CriticSettings
from kurt2rt.core.rla.rla import CRITIC, Rla
from kurt2rt.core.rla.rla_system import RlaSystem


class Opinion(NamedTuple):
    """What the critic thinks of an appraisal situation."""

    value: int
    """-1 bad, 0 neutral, +1 good; 0 where it does not know."""
    appraisal: str
    """Name of the opinion; empty where it does not know."""
    trace_s: float
    """How far back the opinion reaches; 0 where it does not know."""
    rla: Rla | None
    """The nearest appraisal RLA."""
    distance: float
    radius: float
    known: bool
    """Whether the situation lies within that RLA's radius."""

    @property
    def said(self) -> int | None:
        """The value of an opinion that it has; None where it does not know."""
        return self.value if self.known else None


class Critic:
    """Asks the appraisal RLAs of a system what they think."""

    def __init__(self, system: RlaSystem, settings: CriticSettings) -> None:
        self.settings = settings
        self._system = system
        self._dimensions = len(settings.names)
        self._appraisals: dict[str, AppraisalSettings] = {each.name: each for each in settings.appraisals}
        self._opinion: Opinion | None = None
        self._lessons = -1
        self._next_tick = 0

    @property
    def appraisals(self) -> tuple[str, ...]:
        """Names of the opinions that it can be taught."""
        return tuple(self._appraisals)

    @property
    def insert_beyond(self) -> float:
        """Farther than this from the nearest condition another opinion is inserted, else it replaces."""
        return self.settings.learning.insert_beyond_share * self.settings.learning.radius

    def appraise(self, tick: int, circumstances: AppraisalFeatures) -> Opinion | None:
        """What it thinks in this tick, looked up anew every few ticks and after each lesson; None before its first one.

        The features do not change within hundredths of a second, and the search would be the dearest part of a tick.
        """
        lessons = self._system.standing_lessons
        if tick >= self._next_tick or lessons != self._lessons:
            self._opinion = self.opinion(self.to_vector(circumstances))
            self._lessons = lessons
            self._next_tick = tick + self.settings.think_every_ticks
        return self._opinion

    def to_vector(self, circumstances: AppraisalFeatures) -> NDArray[np.float64]:
        """Appraisal situation vector (d,), unweighted, for `opinion` and for conditions."""
        return np.array(circumstances[: self._dimensions], dtype=np.float64)

    def opinion(self, vector: NDArray[np.float64]) -> Opinion | None:
        """What it thinks of an appraisal situation vector (d,); None before its first lesson."""
        match = self._system.match(vector, level=CRITIC)
        if match is None:
            return None
        appraisal = self._appraisals.get(match.rla.action) if match.known else None
        if appraisal is None:  # too far off, asks again, or taught with an appraisal that these settings do not have
            return Opinion(0, "", 0.0, match.rla, match.distance, match.radius, False)
        return Opinion(
            appraisal.value, appraisal.name, appraisal.trace_s, match.rla, match.distance, match.radius, True
        )
