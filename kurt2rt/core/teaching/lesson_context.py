"""Lesson context: the situation that a lesson is about."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class LessonContext(NamedTuple):
    """Situation that a teacher means, its level, and the RLA that drove there."""

    vector: NDArray[np.float64]
    """Situation of the level, shape (d,)."""
    behaviour: str
    """Behaviour that the lesson belongs to; empty if the level has a single one."""
    level: str
    drove: int | None
    """RLA that answered there; None if none did."""
    insert_beyond_share: float
    """A correction farther than this share of R from the nearest condition inserts a new RLA, else it replaces."""
    touched: bool = False
    """True if the robot asked at a bumper: an answer corrects the RLA that pushed on."""
