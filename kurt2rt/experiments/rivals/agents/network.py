"""Network of a trained agent, as a learner that lessons do not change."""

import json
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hal.robot import HIGHEST_COUNTS
from kurt2rt.core.learner.learner import LearnerSetting, Why

Features = NDArray[np.float32]


class Layer(NamedTuple):
    """Linear layer."""

    weights: Features
    """Shape (outputs, inputs)."""
    biases: Features
    """Shape (outputs,)."""


class Network(NamedTuple):
    """Layers of a perceptron; its highest output names the action."""

    layers: tuple[Layer, ...]
    activation: str
    """Function after each layer but the last: relu or tanh."""

    def outputs(self, features: Features) -> Features:
        """Return the outputs (actions,) of features (d,)."""
        values = features
        for layer in self.layers[:-1]:
            values = layer.weights @ values + layer.biases
            values = np.maximum(values, 0.0) if self.activation == "relu" else np.tanh(values)
        last = self.layers[-1]
        outputs: Features = last.weights @ values + last.biases
        return outputs


class AgentInput:
    """Features of a situation as an agent gets them: those with a weight, from -1 to 1, times the weight."""

    def __init__(self, setting: LearnerSetting) -> None:
        self.columns = np.flatnonzero(setting.weights)
        """Places of the features in the situation, ascending."""
        self._weights = setting.weights[self.columns]

    def features(self, situation: NDArray[np.float64]) -> Features:
        """Return the features (d,) of a situation, whose averages may be left out if none has a weight."""
        shares = situation[self.columns] / HIGHEST_COUNTS
        return ((2.0 * shares - 1.0) * self._weights).astype(np.float32)


class AgentNetwork:
    """Learner that decides by the network of a trained agent (`Learner`)."""

    def __init__(self, setting: LearnerSetting, network: Network | None = None) -> None:
        """`network`: None: it knows nothing, and asks."""
        self._input, self._actions, self._network = AgentInput(setting), setting.actions, network

    def decide(self, situation: NDArray[np.float64], *, taught: bool) -> str | None:  # noqa: ARG002 - it never asks
        """Return the action with the highest output for a situation (d,); of equal ones the first."""
        if self._network is None:
            return None
        return self._actions[int(self._network.outputs(self._input.features(situation)).argmax())]

    def lesson(self, situation: NDArray[np.float64], action: str, why: Why) -> None:
        """Learn nothing from a label in a situation (d,): the agent was trained by its own trials."""

    def snapshot(self) -> bytes:
        """Return the network: a line of JSON with the shapes, then the numbers in single precision."""
        if self._network is None:
            return b""
        layers = self._network.layers
        head = {"activation": self._network.activation, "shapes": [layer.weights.shape for layer in layers]}
        numbers = [array.astype("<f4").tobytes() for layer in layers for array in layer]
        return json.dumps(head).encode() + b"\n" + b"".join(numbers)

    def restore(self, data: bytes) -> None:
        """Decide by the network of a snapshot. Raises ValueError for bytes that are none."""
        if not data:
            self._network = None
            return
        text, _, rest = data.partition(b"\n")
        head, numbers = json.loads(text), np.frombuffer(rest, dtype="<f4").astype(np.float32)
        sizes = [size for outputs, inputs in head["shapes"] for size in (outputs * inputs, outputs)]
        if sum(sizes) != len(numbers):
            raise ValueError(f"snapshot of an agent: {len(numbers)} numbers, allowed are {sum(sizes)}")
        parts = iter(np.split(numbers, np.cumsum(sizes)[:-1]))
        layers = tuple(Layer(next(parts).reshape(shape), next(parts)) for shape in head["shapes"])
        self._network = Network(layers, head["activation"])
