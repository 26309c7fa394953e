"""One robot's errands as a job whose result is kept."""

from dataclasses import dataclass
from pathlib import Path

import anyio

from hal.robot_settings import RobotSettings
from hal.simulation import SimulationFactory
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.navigation.guided_tour import navigation_settings
from kurt2rt.experiments.navigation.outcome import ErrandsOutcome, How
from kurt2rt.experiments.navigation.robot_day import teach_and_send
from kurt2rt.experiments.route.lesson import copy_knowledge
from kurt2rt.experiments.study.pool import Tell
from kurt2rt.experiments.study.progress_sum import ProgressSum
from kurt2rt.experiments.study.provenance import Provenance
from kurt2rt.experiments.study.results import Results
from kurt2rt.experiments.study.stored_paths import StoredPaths


@dataclass(frozen=True, slots=True)
class ErrandsJob(StoredPaths):
    """Lead one robot about, and send it to goals."""

    stage: SimulationFactory
    robot: RobotSettings
    task: TaskSettings
    hows: tuple[How, ...]
    seed: int
    basic: Path
    """Knowledge of the streets; it is copied."""
    made_of: Provenance
    results: Results

    @property
    def name(self) -> str:
        """What is shown while it runs."""
        return f"{self.task.name}, seed {self.seed}"

    @property
    def stem(self) -> str:
        """Name of its files, with folders and without ending."""
        return f"{self.task.name}-{self.seed}"

    @property
    def outcome(self) -> type[ErrandsOutcome]:
        """Schema of its result."""
        return ErrandsOutcome

    @property
    def robot_time_s(self) -> float:
        """At most: goals are reached sooner."""
        goals = navigation_settings(self.task).goals
        return self.task.teaching.duration_s + len(self.hows) * goals * self.task.exam.duration_s

    def run(self, tell: Tell) -> None:
        """Teach, send, keep the result and the knowledge."""
        anyio.run(self._run, tell)

    async def _run(self, tell: Tell) -> None:
        with self.results.scratch() as folder:
            knowledge = folder / "knowledge"
            copy_knowledge(self.basic, knowledge)
            outcome = await teach_and_send(
                self.stage,
                self.robot,
                self.task,
                knowledge,
                seed=self.seed,
                hows=self.hows,
                report=ProgressSum(tell).report,
                made_of=self.made_of,
            )
            self.keep(knowledge)
        self.results.write(self, outcome)
