"""Rows of agents of deep reinforcement learning, by name."""

AGENTS = {"dqn": "DQN", "qr-dqn": "QR-DQN", "ppo": "PPO"}
"""Names of the algorithms in tables. Each is trained by rewards of its own trials, so it is no learner of lessons."""
PACKAGES = ("torch", "stable-baselines3", "sb3-contrib")
"""Packages of the extra `rl` that train them."""
_HOUR_S = 3600.0


def agent_title(name: str, life_s: float | None) -> str:
    """Return the name of an agent in tables, with its robot life in s; None: the time of the task's lesson."""
    if life_s is None:
        return f"{AGENTS[name]}, a lesson's time of robot life"
    life = f"{life_s / _HOUR_S:g} h" if life_s >= _HOUR_S else f"{life_s:g} s"
    return f"{AGENTS[name]}, {life} of robot life"
