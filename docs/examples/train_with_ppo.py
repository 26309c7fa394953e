"""Train an agent to follow walls with PPO of stable-baselines3, and compare its drive with the teacher's.

pip install 'kurt2rt[rl]', then: python train_with_ppo.py --steps 50000
"""

import argparse
from collections.abc import Callable
from typing import Any

import gymnasium as gym
import torch
from gymnasium.wrappers import RescaleObservation
from stable_baselines3 import PPO

import kurt2rt.gym  # noqa: F401 - registers the environments

TRAINING_SEED, EXAM_SEED = 1, 1000
"""Seeds of the agent's first training episode, and of the drives that are compared."""


def make(task: str) -> gym.Env[Any, Any]:
    """Return the environment of a task, with observations between -1 and 1."""
    return RescaleObservation(gym.make(task, loop="batch"), -1.0, 1.0)


def drive(env: gym.Env[Any, Any], choose: Callable[[Any, dict[str, Any]], int]) -> tuple[float, float, str]:
    """Drive one episode; return its reward, its length in s, and how it ended."""
    observation, info = env.reset(seed=EXAM_SEED)
    total, over = 0.0, False
    while not over:
        observation, reward, terminated, truncated, info = env.step(choose(observation, info))
        total, over = total + float(reward), terminated or truncated
    return total, info["time_s"], info["ending"]


def main() -> None:
    """Train, then print both drives."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--task", default="kurt2rt/WallFollowing-v0")
    parser.add_argument("--steps", type=int, default=50_000, help="decisions of 0.1 s")
    options = parser.parse_args()
    torch.set_num_threads(1)  # the network is so small that more threads take longer
    env = make(options.task)
    agent = PPO("MlpPolicy", env, n_steps=512, seed=TRAINING_SEED, device="cpu")
    agent.learn(options.steps)
    drives = {
        "agent": drive(env, lambda observation, _: int(agent.predict(observation, deterministic=True)[0])),
        "teacher": drive(env, lambda _, info: info["teacher"]["index"]),
    }
    for who, (reward, seconds, ending) in drives.items():
        print(f"{who}: reward {reward:.0f} in {seconds:.1f} s, end: {ending}")
    env.close()


if __name__ == "__main__":
    main()
