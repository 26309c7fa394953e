"""Jobs of a search: one robot of a trial, or of the check."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import ClassVar

from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.exam_driver import ExamDriver, choose_drivers
from kurt2rt.experiments.lockstep.lesson_driver import LessonDriver, choose_lesson_drivers
from kurt2rt.experiments.search.score import RobotScore, robot_score
from kurt2rt.experiments.search.settings import SEED, Robots, SearchSettings
from kurt2rt.experiments.study.jobs import JobParts
from kurt2rt.experiments.study.provenance import Fingerprints
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


@dataclass(frozen=True, slots=True)
class JobMaker:
    """Maker of the jobs of one search."""

    search: SearchSettings
    parts: JobParts
    fingerprints: Fingerprints

    def trial(self, task: TaskSettings, trial: int) -> tuple[SearchJob, ...]:
        """Return the jobs of a trial, in the order in which its robots are taught."""
        robots = self.search.search
        count = robots.seeds.count
        own = self._drivers(robots, count)
        if trial:  # 1 % of their drives are on the CAN bus too; of the first trial, which has all robots, three
            own = self._drivers(robots, self.search.trials * count)[trial * count : (trial + 1) * count] or own
        return self._jobs("trials", label_of(trial), task, robots, own)

    def check(self, task: TaskSettings, label: str, place: int, of: int) -> tuple[SearchJob, ...]:
        """Return the jobs of the check of one set of settings, which is number `place`, from 0, among `of` sets."""
        robots = self.search.check
        count = robots.seeds.count
        drivers = self._drivers(robots, of * count)
        return self._jobs("check", label, task, robots, drivers[place * count : (place + 1) * count])

    def _drivers(self, robots: Robots, count: int) -> list[tuple[LessonDriver, ExamDriver]]:
        """Return the loops of the lessons and exams of so many robots."""
        lessons = choose_lesson_drivers(self.search.lessons, count)
        return list(zip(lessons, choose_drivers(self.search.exams, count, robots.worlds), strict=True))

    def _jobs(
        self,
        part: str,
        label: str,
        task: TaskSettings,
        robots: Robots,
        drivers: Sequence[tuple[LessonDriver, ExamDriver]],
    ) -> tuple[SearchJob, ...]:
        jobs = []
        for seed, (lesson, driver) in zip(robots.seeds.seeds, drivers, strict=True):
            worlds = robots.worlds_of(seed)
            own = task.model_copy(update={"exam": task.exam.model_copy(update={"worlds": worlds})})
            here = ExamDriver(driver.loop, frozenset(each.replace(SEED, str(seed)) for each in driver.witnesses))
            made = self.fingerprints.of(own, (task.teaching.world, *worlds))
            job = SearchJob(part=part, label=label, task=own, seed=seed, driver=here, made_of=made, **self.parts)
            jobs.append(replace(job, lesson_driver=lesson))
        return tuple(jobs)
