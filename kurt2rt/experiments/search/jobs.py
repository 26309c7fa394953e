"""Job of a search: one robot of a trial, or of the check."""

from dataclasses import dataclass
from typing import ClassVar

from kurt2rt.experiments.search.score import RobotScore, robot_score
from kurt2rt.experiments.study.results import Results
from kurt2rt.experiments.study.seeds import CurriculumJob, SeedOutcome

SHIPPED = "shipped"
"""Label of the shipped settings."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SearchJob(CurriculumJob):
    """Training run and exams of one robot with the settings of a trial; the knowledge is not stored."""

    keeps_knowledge: ClassVar[bool] = False
    part: str
    """`trials` or `check`."""
    label: str
    """Trial by its number, or `SHIPPED`."""

    @property
    def name(self) -> str:
        """Name in progress displays."""
        return f"{self.part} {self.label}, seed {self.seed}"

    @property
    def stem(self) -> str:
        """Path of the result, without the top folder and the ending."""
        return f"{self.part}/{self.label}/{self.task.name}-{self.seed}"

    def score(self, results: Results) -> RobotScore:
        """Return the score of the stored result. Raises StudyError if it is missing or damaged."""
        return robot_score(results.read(self, SeedOutcome))


def label_of(trial: int) -> str:
    """Return the label of a trial's jobs."""
    return f"{trial:04d}"
