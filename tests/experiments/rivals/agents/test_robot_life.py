"""The life of a robot under an agent: its starts, its endings, and what the agent sees."""

from collections.abc import Iterator
from contextlib import closing, contextmanager

import numpy as np
import pytest

from kurt2rt.core.task_settings import TaskSettings, load_task
from kurt2rt.experiments.lockstep.learner_setting import learner_setting
from kurt2rt.experiments.rivals.agents.robot_life import RobotLife, Seen
from tests.experiments.helpers import ROBOT, STAGE

TASK = load_task("wall_following")
FORWARD = np.int64(learner_setting(TASK, ROBOT, seed=1).actions.index("forward"))


@contextmanager
def life_of(seed: int = 3910, task: TaskSettings = TASK) -> Iterator[RobotLife]:
    with closing(RobotLife(STAGE, ROBOT, task, seed, lambda _: None)) as life:
        yield life


def press_on(life: RobotLife, decisions: int) -> list[tuple[Seen, float, bool]]:
    """Drive forward, and set the robot down after each ending; return features, rewards and endings."""
    seen = [(life.reset()[0], 0.0, False)]
    for _ in range(decisions):
        features, reward, terminated, truncated, _ = life.step(FORWARD)
        over = terminated or truncated
        seen.append((life.reset()[0] if over else features, reward, over))
    return seen


def test_life_begins_where_the_lesson_begins() -> None:
    with life_of() as life, closing(STAGE.open("a", 3910, "lesson")) as simulation:
        _, info = life.reset()
        assert info["pose"] == pytest.approx(np.array(simulation.pose), abs=0.01)


def test_collision_ends_an_episode_and_sets_the_robot_down() -> None:
    with life_of() as life:
        drive = press_on(life, 150)
        assert life.decisions == len(drive) - 1
        assert life.seconds == 15.0
        assert life.collisions == life.rescues == sum(over for *_, over in drive) >= 2
        assert life.alarms == 0
        assert life.driving_ns > 0


def test_life_of_a_seed_is_always_the_same() -> None:
    lives = []
    for seed in (3910, 3910, 3911):
        with life_of(seed) as life:
            lives.append([(features.tolist(), reward) for features, reward, _ in press_on(life, 60)])
    assert lives[0] == lives[1] != lives[2]


def test_features_are_those_with_a_weight() -> None:
    setting = learner_setting(TASK, ROBOT, seed=3910)
    with life_of() as life:
        features, _ = life.reset()
    assert features.shape == life.observation_space.shape == (int((setting.weights != 0.0).sum()),)
    assert np.abs(features).max() <= setting.weights.max()
    assert features.min() < 0.0


def test_averages_are_seen_where_they_have_a_weight() -> None:
    learning = TASK.learning.model_copy(update={"past_weight": 0.5})
    with life_of(task=TASK.model_copy(update={"learning": learning})) as life:
        assert life.reset()[0].shape == (2 * 36 - 2,)  # the weight of `minimum front` is 0
