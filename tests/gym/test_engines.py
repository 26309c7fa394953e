"""The compiled batch drives an agent with the numbers of the CAN bus."""

import random
from contextlib import closing
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import SyncVectorEnv

import kurt2rt.gym  # noqa: F401 - registers the environments
from config.settings import SettingsError
from hal.kurt2_settings import Kurt2Settings
from kurt2rt.core.perception.definition import load_situation
from kurt2rt.core.task_settings import load_task
from kurt2rt.experiments.lockstep.batch_mind import feature_table
from kurt2rt.gym.batch_drive import BatchDrive, require_known
from kurt2rt.gym.bus_drive import BusDrive
from kurt2rt.gym.endings import Ending, read_endings
from kurt2rt.gym.environment import Info, TaskEnvironment, load_agent_task
from kurt2rt.gym.episode_setup import PURPOSE, EpisodeSetup
from kurt2rt.gym.registration import ENVIRONMENTS
from simbridge.batch.compiled import IS_COMPILED
from simbridge.contracts.batch import BatchRefusedError, DriveSettings, FixedSpeeds
from simbridge.simulation import Kurt2SimulationFactory
from tests.experiments.helpers import ROBOT
from tests.gym.helpers import environment, follow_teacher, press_on

STEPS = 50 if IS_COMPILED else 5
TASKS = tuple(ENVIRONMENTS.values())


def assert_equal(info: Info, other: Info) -> None:
    assert info.pop("pose").tobytes() == other.pop("pose").tobytes()
    assert info == other


def wandering(seed: int, actions: int) -> list[int]:
    """Return actions that are held for some decisions each, so that turns begin, end and are broken off."""
    chance = random.Random(seed)
    return [action for _ in range(STEPS) for action in [chance.randrange(actions)] * chance.choice((1, 2, 9, 20))]


def drive_both_ways(bus: TaskEnvironment, batch: TaskEnvironment, chooser: random.Random, **reset: Any) -> str:
    """Drive two environments by equal actions; return how the episode ended, after all numbers were equal."""
    (observation, info), (other, other_info) = bus.reset(**reset), batch.reset(**reset)
    assert observation.tobytes() == other.tobytes()
    commands = wandering(chooser.randrange(1000), len(bus.actions))
    for step in range(STEPS):
        action = commands[step] if chooser.random() < 0.3 else info["teacher"]["index"]
        observation, *result, info = bus.step(action)
        other, *other_result, other_info = batch.step(action)
        assert observation.tobytes() == other.tobytes()
        assert result == other_result
        teacher = info["teacher"]
        assert_equal(info, other_info)
        info["teacher"] = teacher
        if info["ending"]:
            break
    return str(info["ending"])


@pytest.mark.parametrize("task", TASKS)
def test_agent_drives_alike_on_the_bus_and_in_the_batch(task: str) -> None:
    with environment(task, averages=True) as bus, environment(task, averages=True, engine="compiled") as batch:
        drive_both_ways(bus, batch, random.Random(1), seed=1)


@pytest.mark.deep
@pytest.mark.parametrize("task", TASKS)
def test_agents_of_many_seeds_drive_alike(task: str) -> None:
    with (
        environment(task, ends_at=("stuck",)) as bus,
        environment(task, ends_at=("stuck",), engine="compiled") as batch,
    ):
        for seed in range(20):
            drive_both_ways(bus, batch, random.Random(seed), seed=seed)


@pytest.mark.parametrize("action", ["flee", "back", "quarter_turn_left", "along_left_wall"])
def test_pressed_on_action_ends_alike_in_both_loops(action: str) -> None:
    with environment("fleeing") as bus, environment("fleeing", engine="compiled") as batch:
        for env in (bus, batch):
            env.reset(seed=4, options={"world": "b"})
        one, other = (press_on(env, action, STEPS) for env in (bus, batch))
        assert one.observation.tobytes() == other.observation.tobytes()
        assert one[1:4] == other[1:4]
        assert_equal(one.info, other.info)


def test_robot_that_leaves_the_batch_goes_on_over_the_bus() -> None:
    # With such a short time any sensor repeats itself for too long at times, and the robot stops.
    guard = ROBOT.guard.model_copy(update={"frozen_infrared_s": 0.11})
    robot = ROBOT.model_copy(update={"guard": guard})
    setup, factory = setup_of(robot), Kurt2SimulationFactory(robot)
    with closing(BusDrive(factory.open("a", 3, PURPOSE), setup)) as bus, closing(BatchDrive(factory, setup)) as batch:
        for _ in range(200):
            one, other = bus.drive("spin_left", 10), batch.drive("spin_left", 10)
            assert one.situation.tobytes() == other.situation.tobytes()
            assert one._replace(situation=other.situation) == other
            assert bus.trail == batch.trail
            if one.ending is not None:
                break
        assert one.ending is Ending.STOPPED


def setup_of(settings: Kurt2Settings, task: str = "wall_following") -> EpisodeSetup:
    """Return the setup of an episode in world A, seed 3, of at most 300 s."""
    return EpisodeSetup(settings, load_agent_task(task), "a", 3, start=None, ends_at=read_endings(()), ticks=30_000)


def test_vector_environment_drives_in_the_batch() -> None:
    vector = gymnasium.make_vec("kurt2rt/WallFollowing-v0", num_envs=2, duration_s=0.5)
    assert isinstance(vector, SyncVectorEnv)
    assert vector.spec is not None
    assert vector.spec.kwargs["vectorization_mode"] == "vector_entry_point"
    assert vector.call("engine") == (("compiled" if IS_COMPILED else "can"),) * 2
    observations, infos = vector.reset(seed=1)
    for _ in range(5):
        observations, _, _, truncated, infos = vector.step(infos["teacher"]["index"])
    assert truncated.all()
    vector.close()
    with environment() as env:
        for place, seed in enumerate((1, 2)):
            assert np.array_equal(observations[place], follow_teacher(env, 5, seed=seed)[-1].observation)


def test_environment_with_an_unknown_loop_is_refused() -> None:
    with pytest.raises(SettingsError, match=r"got wire, allowed can, compiled"), environment(engine="wire"):
        pass


def test_batch_refuses_wheel_speeds_and_taught_actions() -> None:
    definition = load_situation("basic", ROBOT.infrared.names)
    known = DriveSettings(actions={"on": FixedSpeeds(0.3, 0.3)}, minimum_ticks=0)
    require_known(definition, ["on"], known)
    with pytest.raises(BatchRefusedError, match="action dance: the batch knows no taught actions"):
        require_known(definition, ["on", "dance"], known)
    scaled = definition.model_copy(update={"wheel_speed_counts_per_m_s": 5})
    with pytest.raises(BatchRefusedError, match="the batch has no wheel speed left, wheel speed right"):
        require_known(scaled, ["on"], known)
    with pytest.raises(BatchRefusedError, match="a batch does not know wheel speed left in a situation"):
        feature_table(scaled, ROBOT, np.ones(scaled.dimensions), load_task("wall_following"))
