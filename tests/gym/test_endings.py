"""Episodes end at a collision, stuck, stopped, off course or at the end of their time."""

from collections.abc import Iterator
from contextlib import closing, contextmanager

import gymnasium
import pytest

from hal.guard_reason import GuardReason
from kurt2rt.gym.bus_drive import BusDrive
from kurt2rt.gym.endings import Ending, read_endings
from kurt2rt.gym.environment import load_agent_task
from kurt2rt.gym.episode_setup import PURPOSE, EpisodeSetup
from tests.experiments.helpers import ROBOT, STAGE
from tests.gym.helpers import environment, follow_teacher, press_on


@contextmanager
def episode(*ends_at: str, ticks: int = 30_000) -> Iterator[BusDrive]:
    task = load_agent_task("wall_following")
    setup = EpisodeSetup(ROBOT, task, "a", 1, start=None, ends_at=read_endings(ends_at), ticks=ticks)
    with closing(BusDrive(STAGE.open("a", 1, PURPOSE), setup)) as drive:
        yield drive


def test_episode_that_collides_is_terminated() -> None:
    with environment() as env:
        env.reset(seed=1)
        last = press_on(env, "flee", 200)
        assert (last.terminated, last.truncated, last.info["ending"]) == (True, False, "collision")
        assert last.info["collisions"] == 1
        assert last.reward == -1.0
        with pytest.raises(gymnasium.error.ResetNeeded):
            env.step(0)


def test_episode_of_a_standing_robot_ends_stuck() -> None:
    with environment() as env:
        env.reset(seed=1)
        last = press_on(env, "stand", 400)
        assert (last.terminated, last.info["ending"]) == (True, "stuck")
        assert last.info["time_s"] == pytest.approx(30.0, abs=0.1)


def test_episode_at_the_end_of_its_time_is_truncated() -> None:
    with environment(duration_s=1.0) as env:
        drive = follow_teacher(env, 100, seed=1)
        assert len(drive) == 10
        assert (drive[-1].terminated, drive[-1].truncated, drive[-1].info["ending"]) == (False, True, "time")


def test_episode_ends_at_an_emergency_stop() -> None:
    with episode() as drive:
        drive.drive("forward", 10)
        drive.simulation.robot.emergency_stop(GuardReason.WHEELS_DISOBEY)
        assert drive.drive("forward", 10).ending is Ending.STOPPED
