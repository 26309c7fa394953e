"""The situation that a lesson is about."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class LessonContext(NamedTuple):
    """Which situation a teacher means, of which level, and what was done there."""

    vector: NDArray[np.float64]
    """Situation of that level, shape (d,)."""
    behaviour: str
    """The taught behaviour that a lesson about it belongs to; empty where that level has only one system."""
    level: str
    drove: int | None
    """The RLA that answered there; None where none did."""
    insert_beyond_share: float
    """A correction farther than this share of R from the nearest condition inserts a new RLA, else it replaces."""
    touched: bool = False
    """Whether the robot asked what to do with what it touched: an answer corrects the RLA that goes on toward it."""
