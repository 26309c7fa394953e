"""Small networks: fitted by scikit-learn, asked by numpy, because a single row costs scikit-learn ten times as long."""

import warnings
from collections.abc import Sequence
from typing import NamedTuple, NotRequired, TypedDict

import numpy as np
from numpy.typing import NDArray
from sklearn.exceptions import ConvergenceWarning
from sklearn.neural_network import MLPClassifier, MLPRegressor

Points = NDArray[np.float64]

HIDDEN = (64,)
"""Units of the hidden layer. A first choice, not compared with others."""
_EPOCHS, BATCH = 60, 128
_LEAST_STEPS = 600
"""Few labels get more epochs: 30 s of labels would get 180 steps of Adam only."""
_REGULARISATION = 1e-4


class Scale(NamedTuple):
    """Mean and deviation of each feature, by which networks see it."""

    mean: Points
    deviation: Points

    @classmethod
    def of(cls, points: Points) -> "Scale":
        """Return the scale of points (n, d); a feature that never varies has a deviation of 1."""
        deviation = points.std(axis=0)
        return cls(points.mean(axis=0), np.where(deviation > 0.0, deviation, 1.0))

    def __call__(self, points: Points) -> Points:
        """Return points (n, d) or a point (d,) in deviations from the mean."""
        scaled: Points = (points - self.mean) / self.deviation
        return scaled


class Classifier:
    """Network with a probability for each class."""

    def __init__(
        self,
        points: Points,
        classes: NDArray[np.int64],
        count: int,
        seed: int,
        *,
        weights: Points | None = None,
        few: bool = False,
    ) -> None:
        """Fit a network.

        Args:
            points: to learn, shape (n, d), at least one.
            classes: class of each point, 0 to `count` - 1, shape (n,).
            count: number of all classes.
            seed: of the first weights and the order of the points.
            weights: of the points in the loss, shape (n,); None: all count alike.
            few: whether the points are some hundreds at most; then all of them are fitted at once by L-BFGS, in a
                tenth of the time of Adam in batches.
        """
        self._count = count
        self._present = np.unique(classes)
        self._scale = Scale.of(points)
        if len(self._present) > 1:
            options = _FEW if few else _options(len(points))
            network = MLPClassifier(**options, random_state=seed)
            _fit(network, self._scale(points), classes, weights)
            self._layers = list(zip(network.coefs_, network.intercepts_, strict=True))

    def probabilities(self, point: Points) -> Points:
        """Return the probability (count,) of each class at a point (d,)."""
        found = np.zeros(self._count)
        if len(self._present) == 1:
            found[self._present] = 1.0
            return found
        logits = _forward(self._layers, self._scale(point))
        if len(self._present) == 2:  # scikit-learn has one output for two classes
            logits = np.array([0.0, logits[0]])
        powers = np.exp(logits - logits.max())
        found[self._present] = powers / powers.sum()
        return found


class Regressor:
    """Network with one number."""

    def __init__(self, points: Points, values: Points, seed: int) -> None:
        """Fit a network to the values (n,) of points (n, d), at least one; `seed`: as of a classifier."""
        self._scale = Scale.of(points)
        network = MLPRegressor(**_options(len(points)), random_state=seed)
        _fit(network, self._scale(points), values, None)
        self._layers = list(zip(network.coefs_, network.intercepts_, strict=True))

    def values(self, points: Points) -> Points:
        """Return the values (n,) at points (n, d), or that of a point (d,)."""
        values: Points = _forward(self._layers, self._scale(points))[..., 0]
        return values


class _Options(TypedDict):
    hidden_layer_sizes: tuple[int, ...]
    alpha: float
    solver: NotRequired[str]
    batch_size: NotRequired[int]
    max_iter: NotRequired[int]


_FEW = _Options(hidden_layer_sizes=HIDDEN, alpha=_REGULARISATION, solver="lbfgs")


def epochs_of(points: int) -> int:
    """Return the number of epochs for so many points."""
    return max(_EPOCHS, -(-_LEAST_STEPS // -(-points // BATCH)))


def _options(points: int) -> _Options:
    """Return the options of a network for so many points."""
    return {
        "hidden_layer_sizes": HIDDEN,
        "alpha": _REGULARISATION,
        "batch_size": min(BATCH, points),
        "max_iter": epochs_of(points),
    }


def _fit(
    network: MLPClassifier | MLPRegressor, points: Points, said: NDArray[np.generic], weights: Points | None
) -> None:
    with warnings.catch_warnings():
        # The number of epochs is a choice, and no failure to converge.
        warnings.simplefilter("ignore", ConvergenceWarning)
        network.fit(points, said, sample_weight=weights)


def _forward(layers: Sequence[tuple[Points, Points]], points: Points) -> Points:
    for place, (weights, biases) in enumerate(layers):
        points = points @ weights + biases
        if place < len(layers) - 1:
            points = np.maximum(points, 0.0)
    return points
