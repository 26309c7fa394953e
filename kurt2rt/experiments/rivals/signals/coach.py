"""COACH: a policy that follows the gradient of the teacher's rewards."""

import zlib
from collections.abc import Sequence

import numpy as np

from kurt2rt.experiments.rivals.signals.reward_learner import Features, RewardLearner

_STEP = 0.5
"""Learning rate alpha. Not tuned."""
_TRACE_DECAY = 0.95
"""Decay of the eligibility trace for each tick: 0.2 s ago counts a third."""


class Coach(RewardLearner):
    """Real-time COACH (MacGlashan et al., ICML 2017, algorithm 1) with a softmax policy that is linear in the features.

    A reward f moves the weights by alpha f e, where the trace e sums the gradients of log pi over what drove. With a
    teacher an action is drawn by its probability, else the likeliest one drives. The draw is a function of situation
    and seed, so that `decide` changes nothing and decides equally twice.
    """

    def forget(self) -> None:
        """Prefer no action."""
        self._policy = np.zeros((len(self.places), self.dimensions))

    def learn(self, driven: Sequence[tuple[Features, int, int]], value: int) -> None:
        """Move the policy along the trace of what drove."""
        trace = np.zeros_like(self._policy)
        for features, action, age in driven:
            gradient = -np.outer(self._probabilities(features), features)
            gradient[action] += features
            trace += _TRACE_DECAY**age * gradient
        # A second has a hundred ticks, and the paper's steps of the environment are far fewer.
        self._policy += _STEP * value * trace * (1.0 - _TRACE_DECAY)

    def preferences(self, features: Features, *, taught: bool) -> Features:
        """Return the logarithm of the probability (actions,) at features (d,); with a draw while it is `taught`."""
        preferences = self._policy @ features
        if taught:
            drawn_by = (self.setting.seed, zlib.crc32(features.tobytes()))
            preferences = preferences + np.random.default_rng(drawn_by).gumbel(size=len(preferences))
        return preferences

    def _probabilities(self, features: Features) -> Features:
        preferences = self._policy @ features
        powers = np.exp(preferences - preferences.max())
        probabilities: Features = powers / powers.sum()
        return probabilities
