"""Internal critic: an RLA system whose actions are opinions (paper, phase 4)."""

from enum import StrEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from behaviors.judges.judge import AppraisalFeatures
from kurt2rt.core.critic.settings import AppraisalSettings, CriticSettings
from kurt2rt.core.rla.rla import CRITIC, Rla
from kurt2rt.core.rla.rla_system import RlaSystem


class Opinion(NamedTuple):
    """Critic's appraisal of one tick, given by the nearest appraisal RLA."""

    value: int
    """-1 bad, 0 neutral, +1 good; 0 for an unknown situation."""
    appraisal: str
    """Name of the opinion; empty for an unknown situation."""
    trace_s: float
    """Time constant of the opinion's trace; 0 for an unknown situation."""
    rla: Rla | None
    """Nearest appraisal RLA."""
    distance: float
    radius: float
    known: bool
    """True if the situation lies inside that RLA's radius and its appraisal exists."""

    @property
    def said(self) -> int | None:
        """Value -1, 0 or +1 of the opinion; None for an unknown situation."""
        return self.value if self.known else None


class Critic:
    """Internal critic: RLAs whose actions are opinions replace the teacher's rewards (paper, section IV.D).

    It is taught by `Appraise` in phase 4, and speaks in phase 5 once it agreed with its teacher often enough.
    The opinion of an unknown situation is 0. For example: near a wall on the left, "bad", -1.
    """

    def __init__(self, system: RlaSystem, settings: CriticSettings) -> None:
        self.settings = settings
        self._system = system
        self._places = [AppraisalFeatures._fields.index(name) for name in settings.names]
        self._appraisals: dict[str, AppraisalSettings] = {each.name: each for each in settings.appraisals}
        self._opinion: Opinion | None = None
        self._lessons = -1
        self._next_tick = 0

    @property
    def appraisals(self) -> tuple[str, ...]:
        """Names of the opinions that can be taught."""
        return tuple(self._appraisals)

    def appraise(self, tick: int, circumstances: AppraisalFeatures) -> Opinion | None:
        """Return the critic's opinion of the features in this tick; None before the first lesson.

        The search runs every `think_every_ticks` and after each lesson, because it would dominate a tick's time.
        """
        lessons = self._system.history.standing
        if tick >= self._next_tick or lessons != self._lessons:
            self._opinion = self.opinion(self.to_vector(circumstances))
            self._lessons = lessons
            self._next_tick = tick + self.settings.think_every_ticks
        return self._opinion

    def to_vector(self, circumstances: AppraisalFeatures) -> NDArray[np.float64]:
        """Return the appraisal situation (d,), unweighted, for `opinion` and for conditions."""
        return np.array([circumstances[place] for place in self._places], dtype=np.float64)

    def opinion(self, vector: NDArray[np.float64]) -> Opinion | None:
        """Return the opinion of an appraisal situation (d,); None before the first lesson."""
        match = self._system.match(vector, level=CRITIC)
        if match is None:
            return None
        appraisal = self._appraisals.get(match.rla.action) if match.known else None
        if appraisal is None:  # outside the radius, withdrawn, or an appraisal of other settings
            return Opinion(0, "", 0.0, match.rla, match.distance, match.radius, False)
        return Opinion(
            appraisal.value, appraisal.name, appraisal.trace_s, match.rla, match.distance, match.radius, True
        )


class CriticState(StrEnum):
    """Use that the robot makes of the critic's opinions now; the page shows it."""

    LISTENS = "listens"
    """None: before phase 5, or while the critic is not trusted."""
    MEASURES = "measures"
    """They score the knowledge, which does not change meanwhile."""
    NOT_NEEDED = "not needed"
    """They are counted; too little of the driven time was bad."""
    ACTS = "acts"
    """They are signals, like a teacher's rewards."""
