"""EIL: a cost of each action, which is low where the teacher let the robot drive, and high where it took over."""

import numpy as np
from numpy.typing import NDArray

from kurt2rt.core.learner.learner import Why
from kurt2rt.experiments.rivals.holds.hold_learner import HoldLearner, actions_of, points_of
from kurt2rt.experiments.rivals.holds.network import BATCH, HIDDEN, Points, Scale, epochs_of
from kurt2rt.teacher.scripted.teacher_in_charge import Charge

BORDER = 0.0
"""Cost B between good enough and bad; the costs have no other zero."""
_WEIGHT = 1.0
"""Weight lambda of the explicit loss."""
_STEP = 1e-3


class Eil(HoldLearner):
    """Expert Intervention Learning (Spencer et al., RSS 2020, section IV).

    Costs Q(s, a): at most B where the robot drove and its teacher let it, at least B for what was overruled (hinge
    losses of equations 5 and 6), and lowest for the teacher's action while it drives (the explicit loss, here the log
    loss of -Q). It does the action of the lowest cost.
    """

    charge = Charge.BY_TEACHER
    takes_own_samples = True

    def fit(self) -> None:
        """Fit the costs to all samples."""
        self.costs = CostNetwork(len(self.setting.actions), self.setting.seed)
        self.costs.fit(points_of(self.samples), actions_of(self.samples), np.array([each.why for each in self.samples]))

    def act(self, point: Points) -> Points:
        """Return the preference (actions,) of each action at a point (d,): its cost with the other sign."""
        return -self.costs.costs(point)


class CostNetwork:
    """Network of one hidden layer with the cost of each action, fitted by Adam (Kingma and Ba 2015).

    Scikit-learn has no loss of inequalities.
    """

    def __init__(self, actions: int, seed: int) -> None:
        self._actions = actions
        self._rng = np.random.default_rng(seed)

    def fit(self, points: Points, actions: NDArray[np.int64], whys: NDArray[np.str_]) -> None:
        """Fit to points (n, d), at least one, with the action (n,) and the occasion (n,) of each."""
        self._scale = Scale.of(points)
        scaled, hidden = self._scale(points), HIDDEN[0]
        self._layers = [
            self._rng.normal(0.0, np.sqrt(2.0 / points.shape[1]), (points.shape[1], hidden)),
            np.zeros(hidden),
            self._rng.normal(0.0, np.sqrt(1.0 / hidden), (hidden, self._actions)),
            np.zeros(self._actions),
        ]
        means, squares = ([np.zeros_like(each) for each in self._layers] for _ in range(2))
        number = 0
        for _ in range(epochs_of(len(points))):
            order = self._rng.permutation(len(points))
            for begin in range(0, len(points), BATCH):
                batch = order[begin : begin + BATCH]
                number += 1
                for layer, mean, square, slope in zip(
                    self._layers, means, squares, self._slopes(scaled[batch], actions[batch], whys[batch]), strict=True
                ):
                    mean += 0.1 * (slope - mean)
                    square += 0.001 * (slope * slope - square)
                    layer -= _STEP * (mean / (1.0 - 0.9**number)) / (np.sqrt(square / (1.0 - 0.999**number)) + 1e-8)

    def costs(self, point: Points) -> Points:
        """Return the cost (actions,) of each action at a point (d,)."""
        return self._forward(self._scale(point))[1]

    def _forward(self, scaled: Points) -> tuple[Points, Points]:
        first, first_bias, last, last_bias = self._layers
        hidden: Points = np.maximum(scaled @ first + first_bias, 0.0)
        costs: Points = hidden @ last + last_bias
        return hidden, costs

    def _slopes(self, scaled: Points, actions: NDArray[np.int64], whys: NDArray[np.str_]) -> list[Points]:
        """Return the slope of the mean loss of a batch for each layer."""
        hidden, costs = self._forward(scaled)
        outer = cost_slopes(costs, actions, whys) / len(scaled)
        inner = (outer @ self._layers[2].T) * (hidden > 0.0)
        return [scaled.T @ inner, inner.sum(axis=0), hidden.T @ outer, outer.sum(axis=0)]


def cost_slopes(costs: Points, actions: NDArray[np.int64], whys: NDArray[np.str_]) -> Points:
    """Return the slopes (n, actions) of the loss of each sample for its costs.

    Args:
        costs: present costs, shape (n, actions).
        actions: place of the action of each sample, shape (n,).
        whys: its occasion, shape (n,).
    """
    rows = np.arange(len(actions))
    said = costs[rows, actions]
    slopes = np.zeros_like(costs)
    drove, overruled = whys == Why.DROVE, whys == Why.OVERRULED
    slopes[rows, actions] = np.where(drove & (said > BORDER), 1.0, 0.0) - np.where(
        overruled & (said < BORDER), 1.0, 0.0
    )
    powers = np.exp(-(costs - costs.min(axis=1, keepdims=True)))
    chances = powers / powers.sum(axis=1, keepdims=True)
    explicit = -chances
    explicit[rows, actions] += 1.0
    slopes[~(drove | overruled)] = _WEIGHT * explicit[~(drove | overruled)]
    return slopes
