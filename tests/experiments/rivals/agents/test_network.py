"""The network of an agent decides by its highest output, and its bytes bring all of it back."""

import numpy as np
import pytest

from kurt2rt.core.learner.learner import LearnerSetting, Why
from kurt2rt.experiments.rivals.agents.network import AgentInput, AgentNetwork, Layer, Network

SETTING = LearnerSetting(4, np.array([1.0, 0.0, 0.5, 0.0]), 10.0, 0.5, 0.1, ("a", "b", "c"), 1)
HERE = np.array([1023.0, 500.0, 1023.0, 7.0])


def layer(*rows: tuple[float, ...]) -> Layer:
    """Return a layer; the last number of each row is its bias."""
    table = np.array(rows, dtype=np.float32)
    return Layer(table[:, :-1], table[:, -1])


def network(activation: str = "relu") -> Network:
    hidden = layer((1.0, 0.0, 0.0), (0.0, -1.0, 0.0))
    return Network((hidden, layer((1.0, 0.0, 0.0), (0.0, 4.0, 0.1), (-1.0, 0.0, 0.5))), activation)


def test_outputs_pass_through_the_activation() -> None:
    features = np.array([1.0, 0.5], dtype=np.float32)
    assert network("relu").outputs(features) == pytest.approx([1.0, 0.1, -0.5])
    wide, narrow = np.tanh(1.0), np.tanh(-0.5)
    assert network("tanh").outputs(features) == pytest.approx([wide, 4.0 * narrow + 0.1, 0.5 - wide])


def test_input_holds_weighted_features_alone() -> None:
    assert AgentInput(SETTING).features(HERE).tolist() == [1.0, 0.5]
    assert AgentInput(SETTING).features(HERE[:3]).tolist() == [1.0, 0.5]
    assert AgentInput(SETTING).features(np.zeros(4)).tolist() == [-1.0, -0.5]


def test_highest_output_names_the_action() -> None:
    learner = AgentNetwork(SETTING, network())
    assert learner.decide(HERE, taught=False) == "a"
    assert learner.decide(np.zeros(4), taught=True) == "b"


def test_lesson_changes_no_decision() -> None:
    learner = AgentNetwork(SETTING, network())
    learner.lesson(HERE, "b", Why.ANSWER)
    assert learner.decide(HERE, taught=True) == "a"


def test_untrained_network_asks() -> None:
    assert AgentNetwork(SETTING).decide(HERE, taught=False) is None


def test_snapshot_brings_the_network_back() -> None:
    learner, other = AgentNetwork(SETTING, network("tanh")), AgentNetwork(SETTING)
    other.restore(learner.snapshot())
    assert other.snapshot() == learner.snapshot()
    assert other.decide(HERE, taught=False) == learner.decide(HERE, taught=False)
    other.restore(b"")
    assert other.decide(HERE, taught=False) is None


def test_torn_snapshot_is_refused() -> None:
    with pytest.raises(ValueError, match="14 numbers, allowed are 15"):
        AgentNetwork(SETTING).restore(AgentNetwork(SETTING, network()).snapshot()[:-4])
