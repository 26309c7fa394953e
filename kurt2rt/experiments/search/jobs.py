"""Jobs of a search: one robot of a trial, or of the check."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import ClassVar

from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.exam_driver import DriveLoops, choose_witnesses
from kurt2rt.experiments.search.score import RobotScore, robot_score
from kurt2rt.experiments.search.settings import Robots, SearchSettings
from kurt2rt.experiments.study.bus_witness import BusWitnessJob
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
        return self._jobs("trials", label_of(trial), task, self.search.search)

    def check(self, task: TaskSettings, label: str) -> tuple[SearchJob, ...]:
        """Return the jobs of the check of one set of settings."""
        return self._jobs("check", label, task, self.search.check)

    def witnesses_of_trials(self, jobs: Sequence[SearchJob]) -> tuple[BusWitnessJob, ...]:
        """Return the witnesses of these jobs: of 1 % of all trials, and of three of the first, which has all robots."""
        seeds, of_trials = self.search.search.seeds.seeds, [label_of(trial) for trial in range(self.search.trials)]
        chosen = {
            name
            for labels in (of_trials[:1], of_trials)
            for name in choose_witnesses([f"{label}, seed {seed}" for label in labels for seed in seeds], "trials")
        }
        return self._witnesses(job for job in jobs if f"{job.label}, seed {job.seed}" in chosen)

    def witnesses_of_check(self, jobs: Sequence[SearchJob]) -> tuple[BusWitnessJob, ...]:
        """Return the witnesses of the check, whose jobs these are."""
        chosen = choose_witnesses([job.stem for job in jobs], "check")
        return self._witnesses(job for job in jobs if job.stem in chosen)

    def _witnesses(self, jobs: Iterable[SearchJob]) -> tuple[BusWitnessJob, ...]:
        return tuple(map(BusWitnessJob.witness_of, (job for job in jobs if job.loops.in_batch)))

    def _jobs(self, part: str, label: str, task: TaskSettings, robots: Robots) -> tuple[SearchJob, ...]:
        jobs, loops = [], DriveLoops(self.search.lessons, self.search.exams)
        for seed in robots.seeds.seeds:
            worlds = robots.worlds_of(seed)
            own = task.model_copy(update={"exam": task.exam.model_copy(update={"worlds": worlds})})
            made = self.fingerprints.of(own, (task.teaching.world, *worlds))
            jobs.append(SearchJob(part=part, label=label, task=own, seed=seed, loops=loops, made_of=made, **self.parts))
        return tuple(jobs)
