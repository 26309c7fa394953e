"""Life of one robot that an agent drives: episodes in the world of the lesson, rewarded by the judge of the task."""

import random
import time
from collections import Counter
from collections.abc import Callable
from typing import Any

import gymnasium
import numpy as np
from gymnasium.spaces import Box, Discrete
from numpy.typing import NDArray

from hal.batch_refusal import BatchRefusedError
from hal.kurt2_settings import Kurt2Settings
from hal.simulation import SimulationFactory
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.drive_loop import DriveLoop
from kurt2rt.experiments.lockstep.learner_setting import learner_setting
from kurt2rt.experiments.rivals.agents.network import AgentInput
from kurt2rt.gym.endings import Ending
from kurt2rt.gym.environment import TaskEnvironment
from kurt2rt.gym.loops import quickest_loop

Seen = NDArray[np.float32]
Info = dict[str, Any]

DECISION_S = 0.1
"""Time of a decision of the environments."""


class RobotLife(gymnasium.Env[Seen, np.int64]):
    """Environment of one robot for its whole training.

    The first episode begins where the robot's lesson begins. After a collision, or once it is stuck, the robot is set
    down at a random place of the lesson's world, as in lessons, and as often as the task's lesson does so anyway. All
    episodes have the sensors of the robot's seed, and their noise begins again.
    """

    def __init__(
        self,
        factory: SimulationFactory,
        robot: Kurt2Settings,
        task: TaskSettings,
        seed: int,
        on_decision: Callable[[float], None],
    ) -> None:
        """Make the environment, at the quickest loop.

        Args:
            factory: opens the simulation that draws the starts.
            robot: that drives.
            task: with one behaviour and a judge.
            seed: of the robot, and of its starts.
            on_decision: gets the life so far, in s.

        Raises:
            hal.settings.SettingsError: the task has several behaviours or no judge, or does not fit the world.
        """
        setting = learner_setting(task, robot, seed=seed)
        self._input = AgentInput(setting)
        self._seed, self._on_decision = seed, on_decision
        self._environment = TaskEnvironment(
            task,
            robot=robot,
            averages=bool(self._input.columns.max() >= setting.dimensions // 2),
            reward="judge",
            duration_s=task.teaching.reposition_every_s or None,
            loop=quickest_loop().value,
        )
        self.observation_space = Box(-np.inf, np.inf, self._input.columns.shape, np.float32)
        self.action_space = Discrete(len(setting.actions))
        self._in_sight = task.teaching.reposition_to == "in_sight"
        self._chance = random.Random(f"starts of {seed}")
        self._starts = factory.open(task.teaching.world, seed, "lesson")
        self.decisions = 0
        self.endings = Counter[str]()
        """Number of episodes by their endings, without the last one if it goes on."""
        self.driving_ns = 0
        """Processor time of the simulation."""

    @property
    def seconds(self) -> float:
        """Robot life so far, in s."""
        return round(self.decisions * DECISION_S, 1)

    @property
    def collisions(self) -> int:
        """Number of collisions, each of which ended an episode."""
        return self.endings[Ending.COLLISION]

    @property
    def alarms(self) -> int:
        """Number of episodes that a stop of the guard or of the sensor watch ended."""
        return self.endings[Ending.STOPPED]

    @property
    def rescues(self) -> int:
        """Number of episodes after which the robot had to be set down."""
        return self.endings.total() - self.endings[Ending.TIME]

    def reset(self, *, seed: int | None = None, options: Info | None = None) -> tuple[Seen, Info]:  # noqa: ARG002
        """Set the robot down; return the features (d,). `seed` and `options` are left out: it is one robot."""
        began_ns = time.thread_time_ns()
        if self.decisions:
            self._starts.reposition(self._chance, in_sight=self._in_sight)
        start = {"start": self._starts.pose}
        try:
            situation, info = self._environment.reset(seed=self._seed, options=start)
        except BatchRefusedError:
            self._environment.loop = DriveLoop.BUS
            situation, info = self._environment.reset(seed=self._seed, options=start)
        self.driving_ns += time.thread_time_ns() - began_ns
        return self._input.features(situation), info

    def step(self, action: np.int64) -> tuple[Seen, float, bool, bool, Info]:
        """Drive by an action for 0.1 s; return features (d,), reward of the judge, terminated, truncated, information.

        Raises gymnasium.error.ResetNeeded where no episode is under way.
        """
        began_ns = time.thread_time_ns()
        situation, reward, terminated, truncated, info = self._environment.step(action)
        self.driving_ns += time.thread_time_ns() - began_ns
        self.decisions += 1
        self._on_decision(self.seconds)
        if terminated or truncated:
            self.endings[info["ending"]] += 1
        return self._input.features(situation), reward, terminated, truncated, info

    def close(self) -> None:
        """Stop the robot."""
        self._environment.close()
        self._starts.close()
