"""One robot, taught in phase 1 only, with one confidence radius: a curve of Fig. 2."""

from dataclasses import dataclass

import anyio

from hal.robot_settings import RobotSettings
from hal.simulation import SimulationFactory
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.curriculum import run_lesson
from kurt2rt.experiments.paper.outcome import GrowthOutcome, Reading
from kurt2rt.experiments.study.pool import Tell
from kurt2rt.experiments.study.provenance import Provenance
from kurt2rt.experiments.study.results import Results


@dataclass(frozen=True, slots=True)
class GrowthJob:
    """One radius, one reading of the paper, one seed."""

    stage: SimulationFactory
    robot: RobotSettings
    task: TaskSettings
    """With this radius, and no phase but the first."""
    reading: Reading
    seed: int
    made_of: Provenance
    results: Results

    @property
    def radius(self) -> float:
        """Confidence radius R."""
        return self.task.learning.radius

    @property
    def name(self) -> str:
        """What is shown while it runs."""
        return f"growth at R {self.radius:g}, seed {self.seed}" + (", plain" if self.reading == "plain" else "")

    @property
    def file(self) -> str:
        """Path within the folder of results."""
        return f"results/{self.reading}/growth-{self.task.name}-R{self.radius:g}-{self.seed}.json"

    @property
    def outcome(self) -> type[GrowthOutcome]:
        """Schema of its result."""
        return GrowthOutcome

    @property
    def robot_time_s(self) -> float:
        """The lesson."""
        return self.task.teaching.duration_s

    def run(self, tell: Tell) -> None:
        """Teach, keep the result."""
        anyio.run(self._run, tell)

    async def _run(self, tell: Tell) -> None:
        with self.results.scratch() as folder:
            lesson, _ = await run_lesson(
                self.stage,
                self.robot,
                self.task,
                folder / "knowledge",
                seed=self.seed,
                report=lambda _what, done_s, _whole_s: tell(done_s),
            )
        self.results.write(
            self, GrowthOutcome(made_of=self.made_of, seed=self.seed, radius=self.radius, growth=lesson.growth)
        )


def with_radius_only(task: TaskSettings, radius: float, duration_s: float) -> TaskSettings:
    """The task with this radius, taught in phase 1 only."""
    learning = task.learning.model_copy(update={"radius": radius})
    teaching = task.teaching.model_copy(update={"supervised_s": duration_s, "corrections_s": 0.0})
    return task.model_copy(update={"learning": learning, "teaching": teaching})
