"""ThriftyDAgger: the robot asks where it is new or risky, as often as a budget of questions allows."""

import numpy as np
from numpy.typing import NDArray

from kurt2rt.core.learner.learner import Why
from kurt2rt.experiments.rivals.holds.cloning import Ensemble
from kurt2rt.experiments.rivals.holds.network import Points, Regressor
from kurt2rt.teacher.scripted.teacher_in_charge import Charge

_BUDGET = 0.05
"""Share of its own situations in which it may ask."""
_DISCOUNT = 0.98
"""Factor of the future for each 0.1 s: what is 5 s away still counts a third."""


class ThriftyDagger(Ensemble):
    """ThriftyDAgger (Hoque et al., CoRL 2021, algorithm 1).

    Novelty is the variance of the ensemble, risk is 1 - Q with a network Q that is fitted by one step of temporal
    differences (equation 3). Both thresholds of asking are the (1 - budget) quantile of what it met by itself since
    the last fit. It goes on where its discrepancy is below its mean on the labels, and its risk below the median.
    These tasks have no end in which they succeed: in place of a goal, Q is the discounted share of the time to come
    without trouble.
    """

    charge = Charge.BY_ROBOT
    takes_own_samples = True

    def forget(self) -> None:
        """Forget all drives, and thresholds and Q of the last fit."""
        self._path: list[_Step] = []
        self.quality: Regressor | None = None
        self.novel_beyond = self.risky_beyond = np.inf
        self.agrees_within = self.safe_within = np.inf
        self._met_from = 0

    def lesson(self, situation: NDArray[np.float64], action: str, why: Why) -> None:
        """Keep a sample, an action for a situation (d,), and the step of a drive if it was its own."""
        super().lesson(situation, action, why)
        if why is Why.DROVE:
            sample = self.samples[-1]
            self._path.append(_Step(sample.point, sample.action))

    def on_takeover(self, situation: NDArray[np.float64]) -> None:  # noqa: ARG002 - the place does not matter
        """End a drive in a situation (d,): what comes next follows from what its teacher does."""
        if self._path:
            self._path[-1].is_last = True

    def on_trouble(self) -> None:
        """Note that the last step of its own led to trouble."""
        if self._path:
            self._path[-1].is_last = self._path[-1].is_trouble = True

    def fit(self) -> None:
        """Fit the ensemble, then Q, then the thresholds."""
        super().fit()
        self._fit_quality()
        met = [step.point for step in self._path[self._met_from :]]
        self._met_from = len(self._path)
        if met:
            share = 1.0 - self.gate(_BUDGET)
            self.novel_beyond = float(np.quantile([self.novelty(point) for point in met], share))
            risks = [self.risk(point) for point in met]
            self.risky_beyond, self.safe_within = float(np.quantile(risks, share)), float(np.median(risks))
        labelled = self.labelled
        self.agrees_within = float(np.mean([self.discrepancy(each.point, each.action) for each in labelled]))

    def novelty(self, point: Points) -> float:
        """Return the variance of the members' probabilities at a point (d,), summed over the actions, dimensionless."""
        return float(self.variances(point).sum())

    def risk(self, point: Points) -> float:
        """Return the expected share of trouble, 0 to 1, if it goes on by its own action from a point (d,)."""
        if self.quality is None:
            return 0.0
        return float(np.clip(1.0 - self.quality.values(self._input(point, self.own(point))), 0.0, 1.0))

    def asks(self, point: Points) -> bool:
        """Return whether a point (d,) is newer or riskier than the budget allows."""
        return self.novelty(point) > self.novel_beyond or self.risk(point) > self.risky_beyond

    def is_ready(self, point: Points, action: int) -> bool:
        """Return whether it agrees with the held action at a point (d,), and the risk is low."""
        return self.discrepancy(point, action) <= self.agrees_within and self.risk(point) <= self.safe_within

    def _fit_quality(self) -> None:
        """Fit Q to its own drives, with the last Q for what comes after each step."""
        if not self._path:
            return
        inputs = np.array([self._input(step.point, step.action) for step in self._path])
        self.quality = Regressor(inputs, self._targets(), self.setting.seed)

    def _targets(self) -> Points:
        """Return (1 - discount) + discount Q(next) for each step (n,); 0 for a step into trouble."""
        before = self.quality
        targets = np.zeros(len(self._path))
        for place, step in enumerate(self._path):
            after = self._path[place + 1] if place + 1 < len(self._path) and not step.is_last else None
            later = 1.0
            if after is not None and before is not None:
                later = float(np.clip(before.values(self._input(after.point, self.own(after.point))), 0.0, 1.0))
            targets[place] = 0.0 if step.is_trouble else 1.0 - _DISCOUNT + _DISCOUNT * later
        return targets

    def _input(self, point: Points, action: int) -> Points:
        chosen = np.zeros(len(self.setting.actions))
        chosen[action] = 1.0
        return np.concatenate([point, chosen])


class _Step:
    """Step of a drive of its own."""

    __slots__ = ("action", "is_last", "is_trouble", "point")

    def __init__(self, point: Points, action: int) -> None:
        self.point, self.action = point, action
        self.is_last = self.is_trouble = False
