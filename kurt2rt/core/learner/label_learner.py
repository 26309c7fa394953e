"""Learner of all its labels: it keeps them, and is fitted to them before its next decision."""

import json
from abc import ABC, abstractmethod
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from kurt2rt.core.learner.learner import LearnerSetting, Why
from kurt2rt.core.rla.matching import exact_distances


def pack(situations: NDArray[np.float64], actions: Sequence[str]) -> bytes:
    """Return the bytes of situations (n, d) and their n actions: a line of JSON, then the numbers."""
    return json.dumps(list(actions)).encode() + b"\n" + np.ascontiguousarray(situations, dtype="<f8").tobytes()


def unpack(data: bytes, dimensions: int) -> tuple[NDArray[np.float64], list[str]]:
    """Return the situations (n, d) and actions of bytes that `pack` made.

    `dimensions`: length d of a situation.

    Raises:
        ValueError: for bytes that are not such, or of situations of another length.
    """
    head, _, numbers = data.partition(b"\n")
    actions: list[str] = json.loads(head)
    return np.frombuffer(numbers, dtype="<f8").reshape(len(actions), dimensions).astype(np.float64), actions


Points = NDArray[np.float64]


class LabelLearner(ABC):
    """Base of learners whose knowledge is the list of their labels (`Learner`).

    A subclass fits itself in `fit` and chooses in `choose`. It sees points: situations times the weights of the
    setting, so that a distance is one of the RLAs' own, in counts.
    """

    def __init__(self, setting: LearnerSetting) -> None:
        self.setting = setting
        self._situations: list[NDArray[np.float64]] = []
        self._actions: list[str] = []
        self._points = np.empty((0, setting.dimensions))
        self._is_fitted = True

    @abstractmethod
    def fit(self, points: Points, actions: Sequence[str]) -> None:
        """Learn all labels from the beginning: points (n, d) and their n actions, oldest first, at least one."""

    @abstractmethod
    def choose(self, point: Points, *, taught: bool) -> str | None:
        """Return the action for a point (d,), as `Learner.decide` does; called only after `fit`."""

    def decide(self, situation: NDArray[np.float64], *, taught: bool) -> str | None:
        """Return the action for a situation (d,); None asks, as before the first lesson."""
        if not self._actions:
            return None
        if not self._is_fitted:
            self._points = np.array(self._situations) * self.setting.weights
            self.fit(self._points, self._actions)
            self._is_fitted = True
        return self.choose(situation * self.setting.weights, taught=taught)

    def lesson(self, situation: NDArray[np.float64], action: str, why: Why) -> None:  # noqa: ARG002 - all count alike
        """Keep a label: an action for a situation (d,)."""
        self._situations.append(situation)
        self._actions.append(action)
        self._is_fitted = False

    def snapshot(self) -> bytes:
        """Return all labels as bytes, for `restore`."""
        situations = np.array(self._situations).reshape(len(self._actions), self.setting.dimensions)
        return pack(situations, self._actions)

    def restore(self, data: bytes) -> None:
        """Keep the labels of a snapshot. Raises ValueError for bytes that are none."""
        situations, self._actions = unpack(data, self.setting.dimensions)
        self._situations = list(situations)
        self._is_fitted = False

    def gate(self, default: float) -> float:
        """Return the number by which it asks: that of the setting, else `default`, dimensionless."""
        return default if self.setting.gate is None else self.setting.gate

    def stricter(self, *, taught: bool) -> float:
        """Return the fraction of its confidence that suffices now, 0 to 1: less while it is taught, as for RLAs."""
        return self.setting.ask_radius_fraction if taught else 1.0

    def distances(self, point: Points) -> Points:
        """Return the distances (n,) in counts of all labels from a point (d,)."""
        return exact_distances(self._points, point)

    def is_near(self, point: Points, *, taught: bool) -> bool:
        """Return whether a label lies within R of a point (d,), or within the fraction of R while it is taught."""
        return bool(self.distances(point).min() <= self.stricter(taught=taught) * self.setting.radius)
