"""Learner: a part that is taught actions for situations, and decides by them; the RLA system is one of many."""

from collections.abc import Callable
from enum import StrEnum
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray


class Why(StrEnum):
    """Occasion of a lesson."""

    ANSWER = "answer"
    """The robot asked, and its teacher answered."""
    CORRECTION = "correction"
    """The robot did something else, and its teacher named the moment, or corrected the present one."""
    LATE = "late"
    """A correction whose moment was estimated from the teacher's delay."""
    HOLD = "hold"
    """The teacher held an action; its situation is one of those on the way, ten a second."""
    SHOWN = "shown"
    """The teacher drove by hand, and confirmed that the robot is to drive so."""


class Learner(Protocol):
    """Learner of one behaviour: `decide` and `lesson` are all that it and a robot tell each other.

    A situation is a read-only vector (d,) in counts and m/s: the features of now, then their averages. A learner is
    deterministic: the same lessons in the same order give the same decisions. It draws by `LearnerSetting.seed`.
    A learner that raises an error never drives again before it is made new: the robot stands and says so.
    """

    def decide(self, situation: NDArray[np.float64], *, taught: bool) -> str | None:
        """Return the action for a situation (d,); None: the robot stands and asks. Called 100 times a second.

        `taught`: whether a teacher is there who answers, so that a question is cheap.
        """
        ...

    def lesson(self, situation: NDArray[np.float64], action: str, why: Why) -> None:
        """Learn that `action` is right in a situation (d,); the next call of `decide` is to follow it."""
        ...

    def snapshot(self) -> bytes:
        """Return all that the learner knows."""
        ...

    def restore(self, data: bytes) -> None:
        """Know what a snapshot of a learner of the same kind and setting holds, and nothing else."""
        ...


class LearnerSetting(NamedTuple):
    """Task's numbers that every learner is made with."""

    dimensions: int
    """Length d of a situation."""
    weights: NDArray[np.float64]
    """Weight of each feature in the RLAs' distances, shape (d,)."""
    radius: float
    """Confidence radius R of the RLAs, a weighted distance in counts."""
    asks_beyond_share: float
    """Fraction of R beyond which an RLA system asks while it is taught; without a teacher it asks beyond R."""
    insert_beyond_share: float
    """Fraction of R within which a correction replaces an RLA's action."""
    actions: tuple[str, ...]
    """Names of the repertoire."""
    seed: int
    """Seed of all that a learner draws."""
    gate: float | None = None
    """Number by which the learner asks, of a meaning and range of its own; None: the learner's default."""


LearnerFactory = Callable[[LearnerSetting], Learner]
"""Maker of a learner without knowledge."""


class Label(NamedTuple):
    """Lesson as a learner gets it, and the command that gave it."""

    situation: NDArray[np.float64]
    """Situation that the lesson is about, read-only, shape (d,)."""
    behaviour: str
    """Behaviour that the lesson belongs to; empty if the task has a single one."""
    action: str
    why: Why
    command_id: str
    """Id of the command, by which an undo names the lesson."""
