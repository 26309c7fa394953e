"""TAMER: a model of the teacher's reward, whose best action drives."""

from collections.abc import Sequence

import numpy as np

from kurt2rt.experiments.rivals.signals.reward_learner import Features, RewardLearner

CREDIT_TICKS = 20
"""Age of the oldest tick that a reward is about, 0.2 s.

Knox and Stone spread a reward over the delays of a person, 0.2 to 0.8 s before the press. Teachers here name the tick
that they mean, and robots do an action for at least 0.1 s.
"""
_STEP = 0.2
"""Fraction of the error that an update takes away. Knox and Stone give none for a robot; it is not tuned."""


class Tamer(RewardLearner):
    """TAMER (Knox and Stone, K-CAP 2009, algorithm 1), with a linear model H of the reward for each action.

    The action with the highest H drives, and nothing is tried out otherwise: a reward of -1 makes an action fall
    behind the next one. Each tick gets an equal credit, as by the uniform density of the authors' second choice.
    """

    def forget(self) -> None:
        """Expect a reward of 0 for everything."""
        self._model = np.zeros((len(self.places), self.dimensions))

    def learn(self, driven: Sequence[tuple[Features, int, int]], value: int) -> None:
        """Move the model of each credited tick's action towards the reward, by normalised gradient descent."""
        credited = [each for each in driven if each[2] < CREDIT_TICKS]
        for features, action, _ in credited:
            error = value - self._model[action] @ features
            self._model[action] += _STEP * error / len(credited) * features / (features @ features)

    def preferences(self, features: Features, *, taught: bool) -> Features:  # noqa: ARG002 - it never tries out
        """Return the expected reward (actions,) of each action at features (d,)."""
        expected: Features = self._model @ features
        return expected
