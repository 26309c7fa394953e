"""Jobs of the route study: the streets of one robot, and then a route through them."""

from dataclasses import dataclass
from pathlib import Path

from kurt2rt.experiments.lockstep.curriculum import Report, run_lesson
from kurt2rt.experiments.route.lesson import route_of_task, teach_route
from kurt2rt.experiments.route.outcome import BasicOutcome, RouteOutcome
from kurt2rt.experiments.route.variants import Variant
from kurt2rt.experiments.study.jobs import StudyJob
from kurt2rt.knowledge.journal.loading import copy_knowledge


@dataclass(frozen=True, slots=True, kw_only=True)
class BasicJob(StudyJob):
    """Training run of the task that teaches the streets."""

    outcome = BasicOutcome

    @property
    def name(self) -> str:
        """Name in progress displays."""
        return f"{self.task.name}, seed {self.seed}"

    @property
    def stem(self) -> str:
        """Path of result and knowledge, without the top folder and the ending."""
        return f"basic/{self.task.name}-{self.seed}"

    @property
    def robot_time_s(self) -> float:
        """Time of the training run in s."""
        return self.task.teaching.duration_s

    async def measure(self, knowledge: Path, report: Report) -> BasicOutcome:
        """Teach the streets into the file `knowledge` and return the outcome.

        Raises KnowledgeError, SettingsError, LessonLostError.
        """
        lesson, _ = await run_lesson(self.factory, self.robot, self.task, knowledge, seed=self.seed, report=report)
        return BasicOutcome(
            made_of=self.made_of,
            seed=self.seed,
            teaching_s=lesson.teaching_s,
            rlas=len(lesson.rlas),
            knowledge_hash=lesson.knowledge_hash,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class RouteJob(StudyJob):
    """Training run and exam on one route; the task holds the robot's own route."""

    outcome = RouteOutcome
    variant: Variant
    basic: Path
    """Knowledge of the streets; the job copies it."""

    @property
    def decisions(self) -> int:
        """Number of decisions of the route."""
        return route_of_task(self.task).decisions

    @property
    def name(self) -> str:
        """Name in progress displays."""
        return f"{self.task.name} of {self.decisions}, {self.variant.name}, seed {self.seed}"

    @property
    def stem(self) -> str:
        """Path of result and knowledge, without the top folder and the ending."""
        return f"{self.variant.name}/{self.task.name}-{self.decisions}-{self.seed}"

    @property
    def robot_time_s(self) -> float:
        """Time of training run and exam in s."""
        return self.task.teaching.duration_s + self.task.exam.duration_s

    async def measure(self, knowledge: Path, report: Report) -> RouteOutcome:
        """Teach the route on top of the streets into the file `knowledge`, examine it and return the outcome.

        Raises KnowledgeError, SettingsError, LessonLostError.
        """
        copy_knowledge(self.basic, knowledge)
        taught = await teach_route(
            self.factory, self.robot, self.task, self.variant, knowledge, seed=self.seed, report=report
        )
        return taught.outcome(self.made_of)
