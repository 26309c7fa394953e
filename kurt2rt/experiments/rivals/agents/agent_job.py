"""Job of an agent: its training by the judge of a task, and the exams of every rival."""

import time
from contextlib import closing
from dataclasses import dataclass
from importlib.util import find_spec
from typing import ClassVar

from hal.kurt2_settings import Kurt2Settings
from hal.robot_settings import RobotSettings
from hal.settings import SettingsError
from kurt2rt.core.learner.learner import LearnerSetting
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.curriculum import Report
from kurt2rt.experiments.lockstep.drive_loop import DriveLoops
from kurt2rt.experiments.rivals.agents.network import AgentNetwork
from kurt2rt.experiments.rivals.jobs import RivalJob
from kurt2rt.experiments.rivals.learner_clock import LearnerClock
from kurt2rt.experiments.rivals.outcome import PolicyOutcome, RivalCheckpoint, RivalOutcome
from kurt2rt.experiments.rivals.registry import NoLearnerError
from kurt2rt.experiments.rivals.rival import Rival

_SHORTEST_LIFE_S = 1.0


@dataclass(frozen=True, slots=True, kw_only=True)
class AgentJob(RivalJob):
    """Training of one agent as the robot of its seed, in the world of the lesson, and the exams of `RivalJob`.

    The agent drives this robot alone, and is rewarded after each decision. It needs no press, so it is the same after
    each number of presses. Training goes by the quickest loop, also in a witness, which witnesses the exams.
    """

    gives_lesson: ClassVar[bool] = False

    @classmethod
    def require(cls, rival: Rival, task: TaskSettings, robot: RobotSettings) -> None:
        """Check that an agent can be trained.

        Raises:
            NoLearnerError: a package is missing, or the robot life is too short.
            hal.settings.SettingsError: the task has several behaviours or no judge, or the robot is no KURT2.
        """
        where = f"learner {rival.name}"
        if rival.gate is not None and not rival.gate >= _SHORTEST_LIFE_S:
            raise NoLearnerError(
                f"the robot life is too short (got {rival.gate:g} s, allowed {_SHORTEST_LIFE_S:g} s or more)",
                where=where,
                do=f"give {rival.name}=SECONDS, such as {rival.name}=3600",
            )
        require_task_of_agent(task, robot)
        if not all(map(find_spec, ("stable_baselines3", "sb3_contrib"))):
            raise NoLearnerError(
                "stable-baselines3 or sb3-contrib is not installed",
                where=where,
                do="pip install 'kurt2rt[rl]', or name other learners by --learner",
            )

    @property
    def life_s(self) -> float:
        """Robot life that is asked for, in s."""
        return self.task.teaching.duration_s if self.rival.gate is None else self.rival.gate

    @property
    def robot_time_s(self) -> float:
        """Time of the training and of all exams in s, at most."""
        return self.life_s + len(self.task.exam.worlds) * self.task.exam.duration_s

    async def _measure(self, loops: DriveLoops, report: Report) -> RivalOutcome:
        # Not at the top: Gymnasium is an extra, and so is PyTorch, which the training imports.
        from kurt2rt.experiments.rivals.agents.robot_life import DECISION_S, RobotLife
        from kurt2rt.experiments.rivals.agents.training import train

        assert isinstance(self.robot, Kurt2Settings)

        def on_decision(done_s: float) -> None:
            report(f"training in world {self.task.teaching.world}", min(done_s, self.life_s), self.life_s)

        with closing(RobotLife(self.factory, self.robot, self.task, self.seed, on_decision)) as life:
            began_ns = time.thread_time_ns()
            network = train(self.rival.name, life, round(self.life_s / DECISION_S), self.seed)
            training_ns = time.thread_time_ns() - began_ns - life.driving_ns
        clock, failures = LearnerClock(), list[str]()

        def make(setting: LearnerSetting) -> AgentNetwork:
            return AgentNetwork(setting, network)

        team = self._team_of(clock.timed(make))
        policies = self.results.read(self.policy, PolicyOutcome).drives
        drives = await self._drives(team, (), policies, failures, loops.exams, report)
        return RivalOutcome(
            made_of=self.made_of,
            seed=self.seed,
            presses=0,
            labels=life.decisions,
            driven_s=0.0,
            waited_s=0.0,
            asks=0,
            corrections=0,
            collisions=life.collisions,
            alarms=life.alarms,
            rescues=life.rescues,
            teaching_s=life.seconds,
            failure=next(filter(None, failures), ""),
            checkpoints=tuple(
                RivalCheckpoint(presses=presses, teaching_s=life.seconds, drives=drives) for presses in (*self.after, 0)
            ),
            knowledge_bytes=sum(map(len, team.snapshot().values())),
            retraining_s=training_ns / 1e9,
            longest_decision_ms=clock.longest_ms,
            tick_p99_us=None,
            undo_s=0.0,
            undo_restores=False,
            change_ticks=(),
            followed_share=None,
        )


def require_task_of_agent(task: TaskSettings, robot: RobotSettings) -> None:
    """Check that an agent can be trained in a task, by its judge.

    Raises hal.settings.SettingsError: the task has several behaviours or no judge, or the robot is no KURT2.
    """
    where = f"task {task.name}"
    if len(task.behaviours) > 1:
        raise SettingsError(
            f"an agent has one behaviour (got {', '.join(task.behaviours)})", where=where, do="give a task with one"
        )
    if task.judge is None:
        raise SettingsError(
            "an agent is trained by a judge, and the task has none", where=where, do="give a task with a judge"
        )
    if not isinstance(robot, Kurt2Settings):
        raise SettingsError(
            f"agents are trained on the KURT2 alone (got a robot of kind {robot.kind})",
            where=where,
            do="name other learners by --learner",
        )
