"""Base of the learners that learn from rewards of +1 and -1."""

import json
from abc import ABC, abstractmethod
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from kurt2rt.core.learner.learner import Driven, LearnerSetting, Why

Features = NDArray[np.float64]


class RewardLearner(ABC):
    """Learner that drives from the beginning, and gets better by rewards (`Learner`, `SignalLearner`).

    It never asks, so it gets no answers; a label counts as a reward of +1 for its action there. Its knowledge is the
    fold of all rewards. A subclass learns a reward in `learn`, and prefers in `preferences`.
    """

    def __init__(self, setting: LearnerSetting) -> None:
        self.setting = setting
        self._columns = np.flatnonzero(setting.weights)
        self._scale = setting.weights[self._columns] / setting.radius
        self.places = {action: place for place, action in enumerate(setting.actions)}
        self._rewards: list[tuple[tuple[Driven, ...], int]] = []
        self.forget()

    @property
    def dimensions(self) -> int:
        """Number of features: those of the situation with a weight, and a constant 1."""
        return len(self._columns) + 1

    @abstractmethod
    def forget(self) -> None:
        """Know nothing, as a new learner."""

    @abstractmethod
    def learn(self, driven: Sequence[tuple[Features, int, int]], value: int) -> None:
        """Learn a reward; `driven`: features (d,), place of the action and age in ticks, newest first."""

    @abstractmethod
    def preferences(self, features: Features, *, taught: bool) -> Features:
        """Return the preference (actions,) of each action at features (d,); the highest one drives.

        `taught`: whether a teacher is there, so that trying out may be worth it.
        """

    def decide(self, situation: NDArray[np.float64], *, taught: bool) -> str:
        """Return the action with the highest preference for a situation (d,); of equal ones the first."""
        return self.setting.actions[int(self.preferences(self.features(situation), taught=taught).argmax())]

    def lesson(self, situation: NDArray[np.float64], action: str, why: Why) -> None:  # noqa: ARG002 - all count alike
        """Take a label as a reward of +1 for its action in a situation (d,)."""
        self.signal([Driven(situation, action, 0)], 1)

    def signal(self, driven: Sequence[Driven], value: int) -> None:
        """Learn a reward of +1 or -1 for what drove, newest first."""
        kept = tuple(driven)
        self._rewards.append((kept, value))
        self.learn([(self.features(each.situation), self.places[each.action], each.age_ticks) for each in kept], value)

    def features(self, situation: NDArray[np.float64]) -> Features:
        """Return the features (d,) of a situation: weighted, in units of R, and a constant."""
        return np.append(situation[self._columns] * self._scale, 1.0)

    def snapshot(self) -> bytes:
        """Return all rewards: a line of JSON, then the situations."""
        head = [[value, [(each.action, each.age_ticks) for each in driven]] for driven, value in self._rewards]
        situations = [each.situation for driven, _ in self._rewards for each in driven]
        numbers = np.array(situations, dtype="<f8").reshape(len(situations), self.setting.dimensions)
        return json.dumps(head).encode() + b"\n" + numbers.tobytes()

    def restore(self, data: bytes) -> None:
        """Learn the rewards of a snapshot from the beginning. Raises ValueError for bytes that are none."""
        head, _, numbers = data.partition(b"\n")
        situations = iter(np.frombuffer(numbers, dtype="<f8").reshape(-1, self.setting.dimensions).astype(np.float64))
        rewards = [
            (tuple(Driven(next(situations), action, age) for action, age in driven), value)
            for value, driven in json.loads(head)
        ]
        self._rewards = []
        self.forget()
        for driven, value in rewards:
            self.signal(driven, value)
