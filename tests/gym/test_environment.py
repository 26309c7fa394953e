"""Environments keep Gymnasium's contract, and drive as the CAN bus does."""

from collections.abc import Iterator, Sequence
from contextlib import closing

import anyio
import gymnasium
import pytest
from gymnasium.utils.env_checker import check_env

import kurt2rt.gym  # noqa: F401 - registers the environments
from kurt2rt.core.task_settings import load_task
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.experiments.lockstep.runtimes import NoTeachingAllowed
from kurt2rt.gym.bus_drive import CommandedLevel
from kurt2rt.gym.environment import TaskEnvironment
from kurt2rt.gym.registration import ENVIRONMENTS
from kurt2rt.knowledge.task_repertoire import load_task_repertoire
from kurt2rt.platform.clock import LockstepClock
from kurt2rt.runtime import RuntimeOptions, build_runtime
from tests.experiments.helpers import ROBOT, STAGE
from tests.gym.helpers import environment, follow_teacher


@pytest.fixture(scope="module")
def env() -> Iterator[TaskEnvironment]:
    with environment() as opened:
        yield opened


QUICK = ("kurt2rt/WallFollowing-v0", "kurt2rt/StraightOn-v0")
"""One in a room and one in streets; tests/gym/test_loops.py drives all others, too."""


@pytest.mark.parametrize(
    "name", [pytest.param(each, marks=[] if each in QUICK else [pytest.mark.deep]) for each in ENVIRONMENTS]
)
def test_environment_passes_the_checker_without_warning(name: str) -> None:
    with closing(gymnasium.make(name, render_mode="rgb_array")) as made:
        check_env(made.unwrapped)


def test_environment_equal_seeds_give_equal_episodes(env: TaskEnvironment) -> None:
    first, again, other = (follow_teacher(env, 50, seed=seed) for seed in (5, 5, 6))
    assert [step.observation.tobytes() for step in first] == [step.observation.tobytes() for step in again]
    assert [step.info["pose"].tobytes() for step in first] == [step.info["pose"].tobytes() for step in again]
    assert [step.reward for step in first] == [step.reward for step in again]
    assert first[-1].observation.tobytes() != other[-1].observation.tobytes()


def test_environment_equals_the_scheduled_can_loop(env: TaskEnvironment) -> None:
    commands = ["forward", "curve_left", "quarter_turn_right", "along_left_wall", "back"]
    env.reset(seed=11)
    steps = [env.step(env.actions.index(name)) for name in commands]
    records = scheduled_drive(commands)
    assert steps[-1][0].tobytes() == records[-1].situation.vector[:36].tobytes()
    assert [step[4]["action"] for step in steps] == [record.decision.action for record in records]


def scheduled_drive(commands: Sequence[str]) -> list[TickRecord]:
    """Return the record at the end of each command of ten ticks, driven by the scheduler of exams."""
    task = load_task("wall_following")
    level = CommandedLevel(load_task_repertoire(task, ROBOT))
    ends: list[TickRecord] = []
    driven_ticks = 0

    def after_tick(record: TickRecord) -> None:
        nonlocal driven_ticks
        driven_ticks += record.decision.driving
        if record.decision.driving and driven_ticks % 10 == 0:
            ends.append(record)
        if record.decision.asking or (driven_ticks % 10 == 0 and 0 < len(ends) < len(commands)):
            level.command(commands[len(ends)])
        if len(ends) == len(commands):
            runtime.scheduler.end()

    with closing(STAGE.open("a", 11, "exam")) as simulation:
        clock, options = LockstepClock(simulation.step), RuntimeOptions(level_override=level, teacher_available=False)
        runtime = build_runtime(simulation.robot, ROBOT, task, (), NoTeachingAllowed(), clock, options)
        anyio.run(lambda: runtime.scheduler.run(1000, after_tick))
    return ends
