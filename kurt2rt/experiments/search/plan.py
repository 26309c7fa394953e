"""Plan of a search: its task and space, and the jobs of its trials and of the check, one robot each."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import fmean
from typing import ClassVar

from kurt2rt.core.teacher_settings import load_teacher
from kurt2rt.experiments.lockstep.batch_mind import require_known_exams, require_known_lesson
from kurt2rt.experiments.lockstep.engine import Engine, Engines, choose_witnesses
from kurt2rt.experiments.search.settings import CheckSettings, Objective, Robots, SearchSettings, TaskSpace, Values
from kurt2rt.experiments.study.jobs import CurriculumJob, ExaminedOutcome, JobParts, curriculum_time_s, require_places
from kurt2rt.experiments.study.provenance import Fingerprints, Provenance
from kurt2rt.experiments.study.study_plan import BusWitnessJob

SHIPPED = "shipped"
"""Label of the shipped settings."""
PRESSES_OF_A_COLLISION = 10
"""Presses that a collision in a lesson counts as: it may hurt someone, and a press takes a second.

With presses alone a search found settings of fleeing that ask 40 times less, and touch something 8 times as often.
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class SearchJob(CurriculumJob):
    """Job that teaches and examines one robot with the settings of a trial; the knowledge is not stored."""

    keeps_knowledge: ClassVar[bool] = False
    label: str
    """Trial by its number, or `SHIPPED`."""

    def read(self) -> ExaminedOutcome:
        """Return the stored result. Raises StudyError if it is missing or damaged."""
        return self.results.read(self, ExaminedOutcome)


def label_of(trial: int) -> str:
    """Return the label of a trial's jobs, its number in four digits, which sorts their files."""
    return f"{trial:04d}"


@dataclass(frozen=True, slots=True)
class SearchPlan:
    """Checked plan of a search: makes the jobs of each trial, and of the check of the best ones."""

    search: SearchSettings
    space: TaskSpace
    parts: JobParts
    fingerprints: Fingerprints
    made_of: Provenance
    """Provenance of the trials: the shipped settings, the search, its worlds, and the program."""

    @property
    def check(self) -> CheckSettings:
        """Robots and worlds of the check."""
        return self.search.check

    @property
    def folder(self) -> Path:
        """Folder that gets the journal, the results and the report."""
        return self.parts["results"].folder

    def trial_jobs(self, values: Values, trial: int) -> tuple[SearchJob, ...]:
        """Return the jobs of a trial, in the order in which its robots are taught."""
        return self._jobs("trials", label_of(trial), values, self.search.search)

    def check_jobs(self, values: Values, label: str) -> tuple[SearchJob, ...]:
        """Return the jobs of the check of one set of settings."""
        return self._jobs("check", label, values, self.check)

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
        return tuple(map(BusWitnessJob.witness_of, (job for job in jobs if job.engines.in_batch)))

    def _jobs(self, part: str, label: str, values: Values, robots: Robots) -> tuple[SearchJob, ...]:
        jobs, task = [], self.space.task(values)
        for seed in robots.seeds.seeds:
            worlds = robots.worlds_of(seed)
            own = task.model_copy(update={"exam": task.exam.model_copy(update={"worlds": worlds})})
            job = SearchJob(
                **self.parts,
                task=own,
                seed=seed,
                made_of=self.fingerprints.of(own, (task.teaching.world, *worlds)),
                name=f"{part} {label}, seed {seed}",
                stem=f"{part}/{label}/{task.name}-{seed}",
                robot_time_s=curriculum_time_s(own, len(worlds)),
                engines=Engines(self.search.engine, self.search.engine),
                worlds=worlds,
                label=label,
            )
            jobs.append(job)
        return tuple(jobs)


def effort(robot: ExaminedOutcome, objective: Objective) -> int:
    """Return the effort of one robot, to be made small: presses, presses and collisions, or RLAs."""
    match objective:
        case "passed_then_presses":
            return robot.lesson.presses
        case "passed_then_presses_and_collisions":
            return robot.lesson.presses + PRESSES_OF_A_COLLISION * robot.lesson.collisions
        case "passed_then_rlas":
            return robot.lesson.rlas


def exams_of(robots: Iterable[ExaminedOutcome]) -> int:
    """Return the number of exams, also without a verdict: a search must not win by exams that are not judged."""
    return sum(len(robot.drives) for robot in robots)


def score_of(robots: Sequence[ExaminedOutcome], objective: Objective) -> float:
    """Return a score, dimensionless: the share of exams passed, and less than half an exam more for little effort.

    One more exam passed outweighs any effort.
    """
    passed = sum(robot.passed for robot in robots)
    return (passed + 0.5 / (1.0 + fmean(effort(robot, objective) for robot in robots))) / exams_of(robots)


def highest_score(robots: Sequence[ExaminedOutcome], exams: int) -> float:
    """Return a bound that no score reaches, dimensionless: as if all other exams were passed without effort.

    `exams`: number of exams of all robots, also of those that come after `robots`.
    """
    failed = exams_of(robots) - sum(robot.passed for robot in robots)
    return (exams - failed + 0.5) / exams


def make_plan(search: SearchSettings, parts: JobParts, *, changes: Mapping[str, str]) -> SearchPlan:
    """Check task, space and worlds, and return the plan.

    `changes`: values by dotted key of the task's file, of all trials and of the shipped settings. Raises
    config.settings.SettingsError, and BatchRefusedError if a batch does not know the task.
    """
    space = TaskSpace(search, changes, load_teacher(search.teacher))
    task = space.task(space.shipped)
    robots = [(each, seed) for each in (search.search, search.check) for seed in each.seeds.seeds]
    exams = [(world, seed) for each, seed in robots for world in each.worlds_of(seed)]
    worlds = tuple(dict.fromkeys((task.teaching.world, *(world for world, _ in exams))))
    require_places(parts["factory"], task, worlds)
    if search.engine is Engine.COMPILED:
        require_known_lesson(parts["robot"], task)
        require_known_exams(parts["robot"], task)
    fingerprints = Fingerprints(parts["factory"], parts["robot"])
    # More trials, and another number of them checked, leave each trial as it is.
    decides = search.model_dump_json(exclude={"trials": True, "check": {"best"}})
    return SearchPlan(search, space, parts, fingerprints, fingerprints.of(task, worlds, decides))
