"""Parts as a package of another author offers them; tests copy this file to a folder of their own."""

import math
import random
from typing import Annotated

from pydantic import Field

from behaviors.behaviour import Behaviour
from behaviors.judges.judge import AppraisalFeatures, Judge, JudgeSettings
from behaviors.metrics.task_metric import Metrics, MetricSettings, TaskMetric
from behaviors.policies.distances import FRONT, Distances
from behaviors.policies.policy import PolicySettings, ReferencePolicy
from behaviors.repertoire_settings import PluginAction
from hal.robot import SensorReadings, WheelSpeeds
from hal.robot_settings import InfraredSettings, RobotSettings
from simbridge.contracts.simulation import Pose, Simulation

Speed = Annotated[float, Field(ge=0, le=0.5)]


class Turning(PolicySettings):
    """Settings of a policy that drives on, and turns right on the spot at what is ahead."""

    front_m: Annotated[float, Field(ge=0.05, le=0.6)] = 0.3

    def build(self, infrared: InfraredSettings) -> ReferencePolicy:
        """Return the policy."""
        return _Turning(self.front_m, infrared)


class _Turning:
    def __init__(self, front_m: float, infrared: InfraredSettings) -> None:
        self._front_m = front_m
        self._ahead = Distances(infrared).of(*FRONT)

    def choose(self, infrared_counts: tuple[int, ...], behaviour: str) -> str:  # noqa: ARG002 - it knows only one
        return "spin_right" if min(self._ahead(infrared_counts)) < self._front_m else "forward"


class Moving(JudgeSettings):
    """Settings of a judge that praises any drive ahead."""

    fast_m_s: Speed = 0.1

    def build(self) -> Judge:
        """Return the judge."""
        return _Moving(self.fast_m_s)


class _Moving:
    def __init__(self, fast_m_s: float) -> None:
        self._fast_m_s = fast_m_s

    def judge(self, features: AppraisalFeatures) -> int:
        return 1 if features.speed_m_s > self._fast_m_s else 0


class Reach(MetricSettings):
    """Settings of a metric of the largest distance from the start, in m."""

    def build(self, simulation: Simulation, behaviours: tuple[str, ...], chance: random.Random) -> TaskMetric:  # noqa: ARG002
        """Return the metric of one drive."""
        return _Reach(simulation.pose, behaviours[0])


class _Reach:
    unit = "m"
    needs_reset = False

    def __init__(self, pose: Pose, behaviour: str) -> None:
        self.behaviour = behaviour
        self.progress = 0.0
        self._start = pose

    @property
    def findings(self) -> Metrics:
        return {}

    def reset(self, pose: Pose) -> None:
        self._start = pose

    def update(self, pose: Pose) -> None:
        self.progress = max(self.progress, math.hypot(pose.x_m - self._start.x_m, pose.y_m - self._start.y_m))

    def abort(self) -> None:
        pass


class Wiggling(PluginAction):
    """Settings of an action that turns to and fro."""

    speed_m_s: Speed = 0.1
    fails_at_tick: int = 0
    """Tick in which it raises an error; 0: never."""

    def build(self, robot: RobotSettings) -> Behaviour:  # noqa: ARG002 - for any robot
        """Return the action. Raises ValueError for a speed of 0."""
        if not self.speed_m_s:
            raise ValueError("its speed is 0")
        return _Wiggling(self)


class _Wiggling:
    finished = False
    lost = False

    def __init__(self, settings: Wiggling) -> None:
        self._settings = settings
        self._ticks = 0

    def start(self) -> None:
        self._ticks = 0

    def step(self, readings: SensorReadings) -> WheelSpeeds:  # noqa: ARG002 - it looks at nothing
        self._ticks += 1
        if self._ticks == self._settings.fails_at_tick:
            raise RuntimeError("it is dizzy")
        speed_m_s = self._settings.speed_m_s * (1 if self._ticks // 25 % 2 else -1)
        return WheelSpeeds(speed_m_s, -speed_m_s)
