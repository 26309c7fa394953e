"""Several environments of one task, driven in the compiled batch."""

from functools import partial
from typing import Any

from gymnasium.vector import SyncVectorEnv

from kurt2rt.gym.engines import quickest_engine
from kurt2rt.gym.environment import TaskEnvironment


def make_vector_environment(num_envs: int, **options: Any) -> SyncVectorEnv:
    """Return so many environments with the options of one (kurt2rt.gym.environment.TaskEnvironment).

    Without the compiler (extra `fast`) they drive over the CAN bus, with the same numbers: that is quicker then.

    Raises:
        config.settings.SettingsError: for a task, world or option that cannot be used.
    """
    options.setdefault("engine", quickest_engine().value)
    return SyncVectorEnv([partial(TaskEnvironment, **options)] * num_envs)
