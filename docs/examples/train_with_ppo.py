"""Train an agent to follow walls with PPO of stable-baselines3, and examine it next to its teacher's policy.

pip install '.[fast,gym]' stable-baselines3, then: python train_with_ppo.py --steps 50000
"""

import argparse
from collections.abc import Callable
from statistics import median
from typing import Any

import gymnasium as gym
import torch
from gymnasium.wrappers import RescaleObservation
from stable_baselines3 import PPO

import kurt2rt.gym  # noqa: F401 - registers the environments

TRAINING_SEED, FIRST_EXAM = 1, 1000
"""Seed of the agent and of its first training episode, and seed of the first exam."""

Choose = Callable[[Any, dict[str, Any]], int]
"""Function from an observation and its information to an action."""


def make(task: str) -> gym.Env[Any, Any]:
    """Return the environment of a task, with observations between -1 and 1."""
    return RescaleObservation(gym.make(task, engine="compiled"), -1.0, 1.0)  # type: ignore[arg-type]


def drive(env: gym.Env[Any, Any], choose: Choose, world: str, seed: int) -> tuple[float, bool]:
    """Drive one exam; return its reward, and whether it went on to the end of its time."""
    observation, info = env.reset(seed=seed, options={"world": world})
    total, over = 0.0, False
    while not over:
        observation, reward, terminated, truncated, info = env.step(choose(observation, info))
        total, over = total + float(reward), terminated or truncated
    return total, info["ending"] == "time"


def examine(env: gym.Env[Any, Any], choose: Choose, world: str, exams: int) -> str:
    """Return how so many exams in a world went."""
    drives = [drive(env, choose, world, FIRST_EXAM + number) for number in range(exams)]
    whole, reward = sum(whole for _, whole in drives), median(total for total, _ in drives)
    return f"{whole} of {exams} to the end, median reward {reward:.0f}"


def main() -> None:
    """Train, then print the exams of the agent and of its teacher's policy."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--task", default="kurt2rt/WallFollowing-v0")
    parser.add_argument("--worlds", nargs="+", default=["a", "b", "c"], help="worlds of the exams")
    parser.add_argument("--exams", type=int, default=5, help="exams in each world")
    parser.add_argument("--steps", type=int, default=50_000, help="decisions of 0.1 s")
    options = parser.parse_args()
    torch.set_num_threads(1)  # the network is so small that more threads take longer
    env = make(options.task)
    agent = PPO("MlpPolicy", env, n_steps=512, seed=TRAINING_SEED, device="cpu")
    agent.learn(options.steps)
    for world in options.worlds:
        by_agent = examine(env, lambda seen, _: int(agent.predict(seen, deterministic=True)[0]), world, options.exams)
        by_teacher = examine(env, lambda _, info: info["teacher"]["index"], world, options.exams)
        print(f"world {world}: agent {by_agent}; teacher {by_teacher}", flush=True)
    env.close()


if __name__ == "__main__":
    main()
