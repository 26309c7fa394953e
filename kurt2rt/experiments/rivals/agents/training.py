"""Training of an agent by an algorithm of stable-baselines3 or sb3-contrib (extra `rl`)."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from kurt2rt.experiments.rivals.agents.network import Layer, Network
from kurt2rt.experiments.rivals.agents.robot_life import RobotLife

_OF_REPLAY: dict[str, Any] = {
    "learning_rate": 5e-4,
    "train_freq": 1,
    "target_update_interval": 500,
    "exploration_fraction": 0.1,
    "buffer_size": 100_000,
}
"""Settings of DQN and QR-DQN that are no defaults.

The defaults are for millions of steps: a target network that is renewed after 10 000 decisions would stay untrained for
a whole lesson. So it is renewed after 500, and there is a step after each decision, five or ten times as long.
"""
_QUANTILES = 25
"""Quantiles of QR-DQN, in place of 200 for Atari's pictures: a step takes a fifth of the time."""
_OF_ROLLOUTS: dict[str, Any] = {"learning_rate": 1e-3, "n_steps": 256}
"""Settings of PPO that are no defaults: a lesson has one rollout of 2048 decisions, and thirteen of 256."""


def train(name: str, life: RobotLife, decisions: int, seed: int) -> Network:
    """Train an agent for so many decisions; return its network. PPO's life is filled up to whole rollouts.

    The same seed gives the same agent. `name`: dqn, qr-dqn or ppo.
    """
    agent = new_agent(name, life, seed).learn(decisions)
    return network_of(name, agent)


def new_agent(name: str, life: RobotLife, seed: int) -> Any:
    """Return an untrained agent of stable-baselines3."""
    import torch

    torch.set_num_threads(1)  # the network is so small that more threads take longer
    return _ALGORITHMS[name].make("MlpPolicy", life, seed=seed, device="cpu")


def network_of(name: str, agent: Any) -> Network:
    """Return the network by which an agent of stable-baselines3 acts greedily."""
    return _ALGORITHMS[name].network(agent.policy)


def _new_dqn(*of: Any, **settings: Any) -> Any:
    from stable_baselines3 import DQN

    return DQN(*of, **settings, **_OF_REPLAY)


def _new_qr_dqn(*of: Any, **settings: Any) -> Any:
    from sb3_contrib import QRDQN

    return QRDQN(*of, **settings, **_OF_REPLAY, policy_kwargs={"n_quantiles": _QUANTILES})


def _new_ppo(*of: Any, **settings: Any) -> Any:
    from stable_baselines3 import PPO

    return PPO(*of, **settings, **_OF_ROLLOUTS)


def _network_of_dqn(policy: Any) -> Network:
    return Network(_layers(policy.q_net.q_net), "relu")


def _network_of_qr_dqn(policy: Any) -> Network:
    *hidden, (weights, biases) = _layers(policy.quantile_net.quantile_net)
    # The greedy action has the highest mean of its quantiles; a mean of linear outputs is linear, too.
    mean = Layer(
        weights.reshape(_QUANTILES, -1, weights.shape[1]).mean(axis=0), biases.reshape(_QUANTILES, -1).mean(axis=0)
    )
    return Network((*hidden, mean), "relu")


def _network_of_ppo(policy: Any) -> Network:
    return Network(_layers([*policy.mlp_extractor.policy_net, policy.action_net]), "tanh")


class _Algorithm(NamedTuple):
    """Algorithm by what makes an agent of it, and what takes the network out of its policy."""

    make: Callable[..., Any]
    network: Callable[[Any], Network]


_ALGORITHMS = {
    "dqn": _Algorithm(_new_dqn, _network_of_dqn),
    "qr-dqn": _Algorithm(_new_qr_dqn, _network_of_qr_dqn),
    "ppo": _Algorithm(_new_ppo, _network_of_ppo),
}


def _layers(modules: Any) -> tuple[Layer, ...]:
    """Return the linear layers among the modules of a perceptron of torch, in order."""
    arrays = [[part.detach().numpy() for part in module.parameters()] for module in modules]
    return tuple(Layer(*(np.array(part, dtype=np.float32) for part in pair)) for pair in arrays if pair)
