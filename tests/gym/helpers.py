"""Environments and drives for tests."""

from collections.abc import Iterator
from contextlib import closing, contextmanager
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kurt2rt.gym.environment import Info, TaskEnvironment


class Step(NamedTuple):
    """Result of one step of an environment."""

    observation: NDArray[np.float64]
    reward: float
    terminated: bool
    truncated: bool
    info: Info


@contextmanager
def environment(task: str = "wall_following", **options: Any) -> Iterator[TaskEnvironment]:
    with closing(TaskEnvironment(task, **options)) as opened:
        yield opened


def follow_teacher(env: TaskEnvironment, steps: int, **reset: Any) -> list[Step]:
    """Return the steps of a drive by the teacher's answers, until it is over."""
    _, info = env.reset(**reset)
    drive: list[Step] = []
    for _ in range(steps):
        step = Step(*env.step(info["teacher"]["index"]))
        drive.append(step)
        info = step.info
        if step.terminated or step.truncated:
            break
    return drive


def press_on(env: TaskEnvironment, action: str, steps: int) -> Step:
    """Return the last step of a drive by one action, until it is over."""
    for _ in range(steps):
        step = Step(*env.step(env.actions.index(action)))
        if step.terminated or step.truncated:
            break
    return step
