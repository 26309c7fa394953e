"""Options of environments: what they change, and the refusal of what cannot be used."""

from typing import Any

import gymnasium
import numpy as np
import pytest
from numpy.typing import NDArray

from config.settings import SettingsError
from kurt2rt.gym.environment import TaskEnvironment
from tests.gym.helpers import environment, follow_teacher

FREE = (1.0, 0.5, 0.0)


def test_reset_sets_the_robot_down_at_the_start_given() -> None:
    with environment() as env:
        _, info = env.reset(seed=1, options={"start": FREE})
        assert info["pose"] == pytest.approx(FREE, abs=1e-3)


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ({"wind": 1}, "unknown option (got wind, allowed world, start)"),
        ({"world": "nowhere"}, "nowhere"),
        ({"start": (1.0, 2.0)}, "start is not a pose"),
        ({"start": (float("nan"), 1.0, 0.0)}, "start is not a pose"),
        ({"start": (-5.0, 1.0, 0.0)}, "no room at start"),
    ],
)
def test_reset_with_bad_options_is_refused(options: dict[str, Any], says: str) -> None:
    with environment() as env, pytest.raises(SettingsError) as refusal:
        env.reset(seed=1, options=options)
    assert says in str(refusal.value)


@pytest.mark.parametrize(
    ("task", "options", "says"),
    [
        ("streets", {}, "an environment has one behaviour"),
        ("wall_following", {"world": "nowhere"}, "nowhere"),
        ("straight_on", {"world": "a"}, "no streets that meet"),
        ("circle", {"reward": "judge"}, "has no judge; give reward=teacher"),
        ("circle", {"reward": "praise"}, "got praise, allowed judge, teacher"),
        ("circle", {"ends_at": ("time",)}, "got time, allowed collision, stuck"),
        ("circle", {"duration_s": 0.0}, "duration_s: too short"),
        ("circle", {"render_mode": "human"}, "got human, allowed rgb_array"),
    ],
)
def test_environment_of_bad_settings_is_refused(task: str, options: dict[str, Any], says: str) -> None:
    with pytest.raises(SettingsError) as refusal, environment(task, **options):
        pass
    assert says in str(refusal.value)


def test_step_before_reset_and_unknown_action_are_refused() -> None:
    with environment() as env:
        with pytest.raises(gymnasium.error.ResetNeeded):
            env.step(0)
        env.reset(seed=1)
        with pytest.raises(gymnasium.error.InvalidAction, match=r"got 18, allowed 0 to 17"):
            env.step(18)


def frame(env: TaskEnvironment) -> NDArray[np.uint8]:
    drawn = env.render()
    assert drawn is not None
    return drawn


def test_frames_show_the_robot_where_it_drove() -> None:
    with environment(render_mode="rgb_array") as env:
        env.reset(seed=1)
        before = frame(env)
        follow_teacher(env, 20, seed=1)
        after, again = frame(env), frame(env)
        assert before.shape == after.shape == (480, 480, 3)
        assert before.dtype == np.uint8
        assert not np.array_equal(before, after)
        assert np.array_equal(after, again)


def test_environment_without_render_mode_draws_nothing() -> None:
    with environment() as env:
        env.reset(seed=1)
        assert env.render() is None
