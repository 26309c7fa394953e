"""Base of the learners that learn from a teacher in charge."""

from abc import ABC, abstractmethod
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kurt2rt.core.learner.learner import OWN, LearnerSetting, Why
from kurt2rt.core.learner.packing import pack, unpack
from kurt2rt.experiments.rivals.holds.network import Points
from kurt2rt.teacher.scripted.teacher_in_charge import Charge


class Sample(NamedTuple):
    """Lesson, as networks see it."""

    point: Points
    """Features that count, times their weights, shape (d,)."""
    action: int
    """Place of the action among those of the setting."""
    why: Why


class HoldLearner(ABC):
    """Learner of all its samples (`Learner`), with the rules by which control passes between it and its teacher.

    A subclass fits itself in `fit` and decides in `act`. In a lesson with a teacher in charge the run says when it is
    fitted (`fits_at_intervals`); anywhere else it is fitted before the next decision, as other learners are.
    """

    charge: ClassVar[Charge]
    """Rule by which control passes."""
    takes_own_samples: ClassVar[bool] = False
    """True if it learns from what it did itself, too."""

    def __init__(self, setting: LearnerSetting) -> None:
        self.setting = setting
        self._columns = np.flatnonzero(setting.weights)
        self._places = {action: place for place, action in enumerate(setting.actions)}
        self._situations: list[NDArray[np.float64]] = []
        self.samples: list[Sample] = []
        self.fits_at_intervals = False
        """Whether only `refit` fits it."""
        self.stands = False
        """Whether it decides nothing, because it is being fitted; the run sets it."""
        self.advised: str | None = None
        """Action of its teacher that drives in place of its own; the run sets it."""
        self._is_fitted = False
        self.iteration = 0
        """Number of fits so far."""
        self.forget()

    @abstractmethod
    def fit(self) -> None:
        """Learn all samples, at least one of which a teacher labelled."""

    @abstractmethod
    def act(self, point: Points) -> Points:
        """Return the preference (actions,) of each action at a point (d,); the highest one is its own."""

    def asks(self, point: Points) -> bool:  # noqa: ARG002 - a robot that its teacher watches does not ask
        """Return whether it asks for its teacher at a point (d,)."""
        return False

    def is_ready(self, point: Points, action: int) -> bool:  # noqa: ARG002 - only those that ask say so
        """Return whether it can go on alone at a point (d,) where its teacher holds an action."""
        return False

    def on_takeover(self, situation: NDArray[np.float64]) -> None:  # noqa: B027 - few learners need it
        """Note that the teacher took over in a situation (d,)."""

    def on_trouble(self) -> None:  # noqa: B027 - few learners need it
        """Note that the last drive of its own ended in trouble: a collision, a stop of the guard, or a rescue."""

    def drives_by_teacher(self, chance: float) -> bool:  # noqa: ARG002 - only DAgger draws
        """Return whether the action that its teacher names drives now; `chance`: drawn from 0 to 1."""
        return False

    def decide(self, situation: NDArray[np.float64], *, taught: bool) -> str | None:
        """Return the action for a situation (d,); None asks, as before the first fit. Without a teacher it acts."""
        if self.stands:
            return None
        if self.advised is not None:
            return self.advised
        if not self._is_fitted and not self.fits_at_intervals:
            self.refit()
        if not self.iteration:
            return None
        point = self.point(situation)
        if taught and self.asks(point):
            return None
        return self.setting.actions[self.own(point)]

    def lesson(self, situation: NDArray[np.float64], action: str, why: Why) -> None:
        """Keep a sample: an action for a situation (d,)."""
        self._situations.append(situation)
        self.samples.append(Sample(self.point(situation), self._places[action], why))
        self._is_fitted = False

    def refit(self) -> None:
        """Learn all samples, if a teacher labelled one of them."""
        if self.labelled:
            self.fit()
            self.iteration += 1
        self._is_fitted = True

    def snapshot(self) -> bytes:
        """Return all samples."""
        actions = [f"{each.why}:{self.setting.actions[each.action]}" for each in self.samples]
        return pack(np.array(self._situations).reshape(len(actions), self.setting.dimensions), actions)

    def restore(self, data: bytes) -> None:
        """Keep the samples of a snapshot. Raises ValueError for bytes that are none."""
        situations, said = unpack(data, self.setting.dimensions)
        self._situations, self.samples, self.iteration = [], [], 0
        self.forget()
        for situation, text in zip(situations, said, strict=True):
            why, _, action = text.partition(":")
            self.lesson(situation, action, Why(why))

    def forget(self) -> None:  # noqa: B027 - few learners need it
        """Forget what is neither a sample nor fitted to them."""

    def proposal(self, situation: NDArray[np.float64]) -> str | None:
        """Return the action that it would do in a situation (d,), also where it asks; None before the first fit."""
        return self.setting.actions[self.own(self.point(situation))] if self.iteration else None

    def can_go_on(self, situation: NDArray[np.float64], held: str) -> bool:
        """Return whether it can go on alone in a situation (d,) where its teacher holds an action."""
        return bool(self.iteration) and self.is_ready(self.point(situation), self._places[held])

    @property
    def labelled(self) -> list[Sample]:
        """Samples that a teacher labelled, oldest first."""
        return [each for each in self.samples if each.why not in OWN]

    def point(self, situation: NDArray[np.float64]) -> Points:
        """Return the features of a situation (d,) that count, times their weights."""
        point: Points = situation[self._columns] * self.setting.weights[self._columns]
        return point

    def own(self, point: Points) -> int:
        """Return the place of its own action at a point (d,)."""
        return int(self.act(point).argmax())

    def gate(self, default: float) -> float:
        """Return the number by which it asks: that of the setting, else `default`, dimensionless."""
        return default if self.setting.gate is None else self.setting.gate


def points_of(samples: list[Sample]) -> Points:
    """Return the points (n, d) of samples."""
    return np.array([each.point for each in samples])


def actions_of(samples: list[Sample]) -> NDArray[np.int64]:
    """Return the places (n,) of the actions of samples."""
    return np.array([each.action for each in samples], dtype=np.int64)
