"""Deep TAMER: TAMER with a network, and with rewards that are learned more than once."""

from collections.abc import Sequence

import numpy as np
from sklearn.neural_network import MLPRegressor

from kurt2rt.experiments.rivals.signals.reward_learner import Features, RewardLearner
from kurt2rt.experiments.rivals.signals.tamer import CREDIT_TICKS

_HIDDEN = (32,)
_BATCH = 32
"""Credited ticks of earlier rewards that each reward repeats."""


class DeepTamer(RewardLearner):
    """Deep TAMER (Warnell et al., AAAI 2018, algorithm 1) on features in place of images.

    A small network models the reward of a situation and an action. Each reward makes a step on its own ticks, and one
    on as many drawn from all earlier rewards. All credited ticks weigh alike, as by the paper's uniform density.
    """

    def forget(self) -> None:
        """Know nothing: all actions are worth the same until the first reward."""
        self._network: MLPRegressor | None = None
        self._inputs: list[Features] = []
        self._values: list[float] = []
        self._rng = np.random.default_rng(self.setting.seed)
        self._codes = np.eye(len(self.places))

    def learn(self, driven: Sequence[tuple[Features, int, int]], value: int) -> None:
        """Make a step on a reward, and one on earlier ones."""
        if self._network is None:
            self._network = MLPRegressor(
                hidden_layer_sizes=_HIDDEN, learning_rate_init=0.01, random_state=self.setting.seed
            )
        own = [
            np.concatenate((features, self._codes[action])) for features, action, age in driven if age < CREDIT_TICKS
        ]
        self._network.partial_fit(np.array(own), np.full(len(own), float(value)))
        self._inputs += own
        self._values += [float(value)] * len(own)
        drawn = self._rng.integers(0, len(self._inputs), _BATCH)
        self._network.partial_fit(
            np.array([self._inputs[place] for place in drawn]), np.array([self._values[place] for place in drawn])
        )

    def preferences(self, features: Features, *, taught: bool) -> Features:  # noqa: ARG002 - it never tries out
        """Return the expected reward (actions,) of each action at features (d,)."""
        if self._network is None:
            return np.zeros(len(self._codes))
        hidden, last = zip(self._network.coefs_, self._network.intercepts_, strict=True)
        inputs = np.hstack((np.tile(features, (len(self._codes), 1)), self._codes))
        expected: Features = (np.maximum(inputs @ hidden[0] + hidden[1], 0.0) @ last[0] + last[1])[:, 0]
        return expected
