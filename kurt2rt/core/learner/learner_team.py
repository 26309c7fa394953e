"""Learner team: one learner for each taught behaviour, and the labels that they were given."""

from collections.abc import Callable, Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from kurt2rt.core.learner.learner import Label, Learner, LearnerFactory, LearnerSetting
from kurt2rt.core.rla.lesson_history import hold_of

_LONGEST_ERROR = 200
"""Characters of a learner's error that are shown."""


class LearnerTeam:
    """Learners of one robot, one for each behaviour, as an RLA answers only in its own behaviour.

    Their knowledge is the fold of the standing labels, so an undo of any of them teaches new learners the others.
    """

    def __init__(self, name: str, make: LearnerFactory, setting: LearnerSetting, behaviours: Sequence[str]) -> None:
        """Make learners without knowledge.

        Args:
            name: of the kind of learner, for texts.
            make: returns a new learner.
            setting: of all learners.
            behaviours: taught behaviours of the task.
        """
        self.name = name
        self._make, self._setting, self._behaviours = make, setting, tuple(behaviours)
        self._labels: list[Label] = []
        self.failure = ""
        """Failure of a learner in one line, after which none of them decides; empty without one."""
        self._learners = self._new()

    @property
    def labels(self) -> tuple[Label, ...]:
        """Labels that were not undone, oldest first."""
        return tuple(self._labels)

    def learner(self, behaviour: str) -> Learner:
        """Return the learner of a behaviour of the task."""
        return self._learners[behaviour]

    def decide(self, behaviour: str, situation: NDArray[np.float64], *, taught: bool) -> str | None:
        """Return the action for a situation (d,); None if the learner asks, or `failure` says that it cannot decide.

        `taught`: whether a teacher is there who answers.
        """
        if self.failure:
            return None
        seen = situation.view()
        seen.flags.writeable = False
        try:
            action = self._learners[behaviour].decide(seen, taught=taught)
        except Exception as error:  # noqa: BLE001 - a learner may be anyone's; the robot stands, and says why
            self._fail(error)
            return None
        if action is not None and action not in self._setting.actions:
            self._fail(ValueError(f"decided {action!r}, which is none of {', '.join(self._setting.actions)}"))
            return None
        return action

    def teach(self, label: Label) -> None:
        """Give a label to the learner of its behaviour; an error of it becomes `failure`."""
        self._labels.append(label)
        self._give(label)

    def teach_all(self, labels: Iterable[Label]) -> None:
        """Give labels to the learners of their behaviours, in order."""
        for label in labels:
            self.teach(label)

    def undo(self, command_id: str) -> None:
        """Teach new learners all labels except those of a command; nothing happens if it gave none."""
        self._keep(lambda label: label.command_id != command_id)

    def undo_hold(self, hold: str) -> None:
        """Teach new learners all labels except those of a hold, also of those that changed no RLA."""
        self._keep(lambda label: hold_of(label.command_id) != hold)

    def snapshot(self) -> dict[str, bytes]:
        """Return the snapshot of each behaviour's learner."""
        return {behaviour: learner.snapshot() for behaviour, learner in self._learners.items()}

    def _new(self) -> dict[str, Learner]:
        return {behaviour: self._make(self._setting) for behaviour in self._behaviours}

    def _keep(self, stays: Callable[[Label], bool]) -> None:
        kept = [label for label in self._labels if stays(label)]
        if len(kept) == len(self._labels):
            return
        self._labels, self.failure, self._learners = kept, "", self._new()
        for label in kept:
            self._give(label)

    def _give(self, label: Label) -> None:
        if self.failure:
            return
        try:
            self._learners[label.behaviour].lesson(label.situation, label.action, label.why)
        except Exception as error:  # noqa: BLE001 - as above: what it would decide now is unknown
            self._fail(error)

    def _fail(self, error: Exception) -> None:
        text = " ".join(f"{type(error).__name__}: {error}".split())
        self.failure = f"{self.name}: {text}"[:_LONGEST_ERROR]
