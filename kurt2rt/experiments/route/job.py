"""One robot's work in two pieces: the streets, and then a route through them."""

from dataclasses import dataclass
from pathlib import Path

import anyio

from hal.robot_settings import RobotSettings
from hal.simulation import SimulationFactory
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.curriculum import Report, run_lesson
from kurt2rt.experiments.route.lesson import copy_knowledge, route_of_task, teach_route
from kurt2rt.experiments.route.outcome import BasicOutcome, RouteOutcome
from kurt2rt.experiments.route.variants import Variant
from kurt2rt.experiments.study.pool import Tell
from kurt2rt.experiments.study.progress_sum import ProgressSum
from kurt2rt.experiments.study.provenance import Provenance
from kurt2rt.experiments.study.results import Results
from kurt2rt.experiments.study.stored_paths import StoredPaths

_BASIC = "basic"


@dataclass(frozen=True, slots=True)
class BasicJob(StoredPaths):
    """The task that teaches the streets, with its own lesson."""

    stage: SimulationFactory
    robot: RobotSettings
    task: TaskSettings
    seed: int
    made_of: Provenance
    results: Results

    @property
    def name(self) -> str:
        """What is shown while it runs."""
        return f"{self.task.name}, seed {self.seed}"

    @property
    def stem(self) -> str:
        """Name of its files, with folders and without ending."""
        return f"{_BASIC}/{self.task.name}-{self.seed}"

    @property
    def outcome(self) -> type[BasicOutcome]:
        """Schema of its result."""
        return BasicOutcome

    @property
    def robot_time_s(self) -> float:
        """The lesson."""
        return self.task.teaching.duration_s

    def run(self, tell: Tell) -> None:
        """Teach, keep the result and the knowledge."""
        anyio.run(self._run, ProgressSum(tell).report)

    async def _run(self, report: Report) -> None:
        with self.results.scratch() as folder:
            knowledge = folder / "knowledge"
            lesson, _ = await run_lesson(self.stage, self.robot, self.task, knowledge, seed=self.seed, report=report)
            self.keep(knowledge)
        outcome = BasicOutcome(
            made_of=self.made_of,
            seed=self.seed,
            teaching_s=lesson.teaching_s,
            rlas=len(lesson.rlas),
            knowledge_hash=lesson.knowledge_hash,
        )
        self.results.write(self, outcome)


@dataclass(frozen=True, slots=True)
class RouteJob(StoredPaths):
    """One route, taught in one way to one robot, and driven by it."""

    stage: SimulationFactory
    robot: RobotSettings
    task: TaskSettings
    """With the route of this robot."""
    variant: Variant
    seed: int
    basic: Path
    """Knowledge of the streets; it is copied."""
    made_of: Provenance
    results: Results

    @property
    def decisions(self) -> int:
        """Of its route."""
        return route_of_task(self.task).decisions

    @property
    def name(self) -> str:
        """What is shown while it runs."""
        return f"{self.task.name} of {self.decisions}, {self.variant.name}, seed {self.seed}"

    @property
    def stem(self) -> str:
        """Name of its files, with folders and without ending."""
        return f"{self.variant.name}/{self.task.name}-{self.decisions}-{self.seed}"

    @property
    def outcome(self) -> type[RouteOutcome]:
        """Schema of its result."""
        return RouteOutcome

    @property
    def robot_time_s(self) -> float:
        """Lesson and exam."""
        return self.task.teaching.duration_s + self.task.exam.duration_s

    def run(self, tell: Tell) -> None:
        """Teach, examine, keep the result and the knowledge."""
        anyio.run(self._run, tell)

    async def _run(self, tell: Tell) -> None:
        report = ProgressSum(tell).report
        with self.results.scratch() as folder:
            knowledge = folder / "knowledge"
            copy_knowledge(self.basic, knowledge)
            taught = await teach_route(
                self.stage, self.robot, self.task, self.variant, knowledge, seed=self.seed, report=report
            )
            self.keep(knowledge)
        self.results.write(self, taught.outcome(self.made_of))
