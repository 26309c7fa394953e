"""Bases of the jobs of a study: drives in simulated time with a stored result, or training and exams of one robot."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar, TypedDict

import anyio

from hal.robot_settings import RobotSettings
from hal.settings import Settings
from hal.simulation import SimulationFactory
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.curriculum import Report
from kurt2rt.experiments.lockstep.drive_loop import ON_BUS, DriveLoops
from kurt2rt.experiments.study.pool import Progress
from kurt2rt.experiments.study.progress_sum import ProgressSum
from kurt2rt.experiments.study.provenance import Provenance
from kurt2rt.experiments.study.results import Results


class JobParts(TypedDict):
    """Fields that all jobs of a study share."""

    factory: SimulationFactory
    robot: RobotSettings
    results: Results


@dataclass(frozen=True, slots=True, kw_only=True)
class SimulationJob(ABC):
    """Job in simulated time with a stored result, in a process of its own; it stores no knowledge."""

    outcome: ClassVar[type[Settings]]
    """Schema of the result."""
    replaces_others: ClassVar[bool] = False
    gives_lesson: ClassVar[bool] = False
    """True if the job gives the task's own lesson to a robot without knowledge, as a batch can."""
    gives_exams: ClassVar[bool] = False
    """True if the job examines robots that were taught its task, as a batch can."""
    factory: SimulationFactory
    robot: RobotSettings
    task: TaskSettings
    made_of: Provenance
    results: Results
    loops: DriveLoops = ON_BUS
    """Loops that drive, which change no result."""

    @property
    @abstractmethod
    def name(self) -> str:
        """Name in progress displays."""

    @property
    @abstractmethod
    def file(self) -> str:
        """Path of the result within the folder of results."""

    @property
    @abstractmethod
    def robot_time_s(self) -> float:
        """Simulated time in s, at most."""

    @property
    def knowledge_name(self) -> str | None:
        """Path of the stored knowledge within the folder of results; None: the job stores none."""
        return None


@dataclass(frozen=True, slots=True, kw_only=True)
class StudyJob(SimulationJob):
    """Training and exams of one robot."""

    keeps_knowledge: ClassVar[bool] = True
    seed: int

    @property
    @abstractmethod
    def stem(self) -> str:
        """Path of result and knowledge, without the top folder and the ending."""

    @abstractmethod
    async def measure(self, knowledge: Path, report: Report) -> Settings:
        """Train and examine the robot and return the outcome; `knowledge` is the file to teach into.

        Raises KnowledgeError, SettingsError, LessonLostError.
        """

    @property
    def file(self) -> str:
        """Path of the result within the folder of results."""
        return f"results/{self.stem}.json"

    @property
    def knowledge_name(self) -> str | None:
        """Path of the stored knowledge within the folder of results; None: the job stores none."""
        return f"knowledge/{self.stem}.knowledge" if self.keeps_knowledge else None

    @property
    def knowledge(self) -> Path:
        """Path of the stored knowledge file in the folder of results; it exists after the job."""
        assert self.knowledge_name is not None
        return self.results.folder / self.knowledge_name

    def run(self, on_progress: Progress) -> None:
        """Run the job in an event loop of its own, and store result and knowledge; `on_progress` gets robot time in s.

        Raises the errors of `measure`, and OSError if the results cannot be stored.
        """
        anyio.run(self._run, ProgressSum(on_progress).report)

    async def _run(self, report: Report) -> None:
        with self.results.scratch() as folder:
            outcome = await self.measure(folder / "knowledge", report)
            if self.knowledge_name is not None:
                self.results.keep(folder / "knowledge", self.knowledge_name)
        self.results.write(self, outcome)
