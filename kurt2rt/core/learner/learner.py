"""Learner: a part that is taught actions for situations, and decides by them; the RLA system is one of many."""

from collections.abc import Callable
from enum import StrEnum
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray


class Why(StrEnum):
    """Occasion of a lesson; a learner may weigh lessons by it."""

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
    """Part that is taught actions for situations, and decides by them: the RLA system, or one to compare with it.

    A robot calls only `decide` and `lesson`; each taught behaviour has a learner of its own.
    For example k-NN: `lesson` stores a row, `decide` returns the majority of the nearest rows, None far from all.

    A situation is a read-only vector (d,) in counts and m/s: the features of now, then their averages. A learner is
    deterministic: the same lessons in the same order give the same decisions. It draws by `LearnerSetting.seed`.
    A learner that raises an error never drives again before it is made new: the robot stands, and reports the error.
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
        """Replace all knowledge by that in a snapshot of a learner of the same kind and setting."""
        ...


class LearnerSetting(NamedTuple):
    """Numbers of a task that every learner is made with: length, weights, R, actions, seed and gate.

    A `LearnerFactory` gets one at the start of a run. For example gate 0.8 of k-NN: it asks unless 80 % of the nearest
    labels agree.
    """

    dimensions: int
    """Length d of a situation."""
    weights: NDArray[np.float64]
    """Weight of each feature in the RLAs' distances, shape (d,)."""
    radius: float
    """Confidence radius R of the RLAs, a weighted distance in counts."""
    ask_radius_fraction: float
    """Fraction of R beyond which an RLA system asks while it is taught; without a teacher it asks beyond R."""
    insert_radius_fraction: float
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
    """Right action for one situation: a lesson in the form that every learner can use.

    `LearnerLevel` makes one from each lesson that gives or changes an action. An undo removes the labels of its
    command, and the learner learns the rest again.
    """

    situation: NDArray[np.float64]
    """Situation that the lesson is about, read-only, shape (d,)."""
    behaviour: str
    """Behaviour that the lesson belongs to; empty if the task has a single one."""
    action: str
    why: Why
    command_id: str
    """Id of the command, by which an undo names the lesson."""
