"""Job of the navigation study: a guided tour of one robot, and its drives to goals."""

from dataclasses import dataclass
from pathlib import Path

from kurt2rt.experiments.lockstep.curriculum import Report
from kurt2rt.experiments.navigation.guided_tour import navigation_settings
from kurt2rt.experiments.navigation.outcome import ErrandsOutcome, Strategy
from kurt2rt.experiments.navigation.robot_day import teach_and_send
from kurt2rt.experiments.study.jobs import StudyJob
from kurt2rt.knowledge.journal.loading import copy_knowledge


@dataclass(frozen=True, slots=True, kw_only=True)
class NavigationJob(StudyJob):
    """Guided tour of one robot, and its drives to goals by each strategy."""

    outcome = ErrandsOutcome
    strategies: tuple[Strategy, ...]
    basic: Path
    """Knowledge of the streets; the job copies it."""

    @property
    def name(self) -> str:
        """Name in progress displays."""
        return f"{self.task.name}, seed {self.seed}"

    @property
    def stem(self) -> str:
        """Path of result and knowledge, without the top folder and the ending."""
        return f"{self.task.name}-{self.seed}"

    @property
    def robot_time_s(self) -> float:
        """Time of the tour, and of all goals if each takes the whole time, in s."""
        goals = navigation_settings(self.task).goals
        return self.task.teaching.duration_s + len(self.strategies) * goals * self.task.exam.duration_s

    async def measure(self, knowledge: Path, report: Report) -> ErrandsOutcome:
        """Lead the robot through the town and send it to its goals; return the outcome.

        `knowledge`: path of the file to make. Raises KnowledgeError, SettingsError, LessonLostError.
        """
        copy_knowledge(self.basic, knowledge)
        outcome = await teach_and_send(
            self.factory,
            self.robot,
            self.task,
            knowledge,
            seed=self.seed,
            strategies=self.strategies,
            report=report,
        )
        return outcome.model_copy(update={"made_of": self.made_of})
