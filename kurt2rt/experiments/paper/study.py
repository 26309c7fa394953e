"""Paper study: each task in each reading, taught and examined with many seeds, and the curves of Fig. 2."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import ClassVar, Literal, NamedTuple

from config.settings_files import find_config
from kurt2rt.core.phase_settings import PHASES
from kurt2rt.core.task_settings import TaskSettings, load_task, taught_by_named
from kurt2rt.experiments.lockstep.compatibility import require_metric
from kurt2rt.experiments.lockstep.curriculum import Report
from kurt2rt.experiments.paper.settings import ExperimentSettings, Extent, PaperSettings
from kurt2rt.experiments.study.jobs import (
    CurriculumJob,
    ExaminedOutcome,
    JobParts,
    Outcome,
    StudyError,
    StudyJob,
    curriculum_time_s,
)
from kurt2rt.experiments.study.provenance import Fingerprints
from kurt2rt.experiments.study.study_plan import EngineRequest, Group, StudyPlan, group_by, read_groups
from kurt2rt.experiments.study.table import ROBOTS

Reading = Literal["shipped", "plain"]
"""Reading of the paper's scheme: the settings of this project, or the literal ones."""


class GrowthOutcome(Outcome):
    """Stored outcome of a robot taught in phase 1 only: how its number of RLAs grew (Fig. 2)."""

    growth: tuple[int, ...]
    """Number of RLAs after each second."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TaughtJob(CurriculumJob):
    """Job that teaches one robot one task in one reading, and examines it, also in unseen worlds."""

    keeps_places: ClassVar[bool] = True
    settings: ExperimentSettings
    reading: Reading


@dataclass(frozen=True, slots=True, kw_only=True)
class GrowthJob(StudyJob):
    """Robot of one confidence radius, taught in phase 1 only: a curve of Fig. 2."""

    outcome = GrowthOutcome
    keeps_knowledge: ClassVar[bool] = False
    gives_lesson: ClassVar[bool] = True
    reading: Reading

    @property
    def radius(self) -> float:
        """Confidence radius R in counts."""
        return self.task.learning.radius

    async def measure(self, knowledge: Path, report: Report) -> GrowthOutcome:
        """Teach the task in phase 1 into the file `knowledge` and return the number of RLAs after each second."""
        lesson, _ = await self.teach(knowledge, report)
        return GrowthOutcome(made_of=self.made_of, seed=self.seed, growth=lesson.growth)


class PaperExtent(NamedTuple):
    """Subject of the paper study: its settings, and limits for a quick part of it."""

    paper: PaperSettings
    extent: Extent


def make_plan(
    paper: PaperSettings,
    extent: Extent,
    seeds: Sequence[int],
    readings: Sequence[Reading],
    parts: JobParts,
    *,
    tasks: Sequence[str] = (),
    engine: EngineRequest = EngineRequest.CAN,
) -> StudyPlan[PaperExtent]:
    """Check every task and world, and return the jobs, a robot for each seed.

    `tasks`: names or paths; empty: all. A task without an experiment in `paper` has no targets. Raises
    config.settings.SettingsError if a task and a world do not fit, StudyError if two tasks have one name, or a target
    has no exam.
    """
    paper = extent.paper(paper)
    chosen = _chosen(paper, extent, tasks)
    _require_tasks(chosen, parts)
    fingerprints = Fingerprints(parts["factory"], parts["robot"], ("paper", "paper_defaults", *PHASES))
    robots: list[StudyJob] = []
    curves: list[StudyJob] = []
    for reading, each in product(readings, chosen):
        task = taught_by_named(extent.task(load_task(each.task, paper_defaults=reading == "plain")), paper.teacher)
        end = ", plain" if reading == "plain" else ""
        for seed in seeds:
            worlds = (*task.exam.worlds, *unseen_of(seed, each))
            job = TaughtJob(
                **parts,
                task=task,
                seed=seed,
                made_of=fingerprints.of(task, (task.teaching.world, *worlds)),
                name=f"{task.name}, seed {seed}{end}",
                stem=f"{reading}/{task.name}-{seed}",
                robot_time_s=curriculum_time_s(task, len(worlds)),
                settings=each,
                reading=reading,
                worlds=worlds,
            )
            robots.append(job)
        for radius in paper.growth.radii if each.task == paper.growth.task else ():
            own = _with_radius_only(task, radius, paper.growth.duration_s)
            made = fingerprints.of(own, (own.teaching.world,))
            curves += (
                GrowthJob(
                    **parts,
                    task=own,
                    seed=seed,
                    made_of=made,
                    name=f"growth at R {radius:g}, seed {seed}{end}",
                    stem=f"{reading}/growth-{own.name}-R{radius:g}-{seed}",
                    robot_time_s=own.teaching.duration_s,
                    reading=reading,
                )
                for seed in seeds[: paper.growth.robots]
            )
    plan = StudyPlan(PaperExtent(paper, extent), tuple(seeds), (*robots, *curves))
    return plan.driven(engine, parts["robot"])


def unseen_of(seed: int, experiment: ExperimentSettings) -> tuple[str, ...]:
    """Return the names of the generated worlds of one seed; 20 successive seeds share all of them."""
    return experiment.unseen.names[seed % ROBOTS :: ROBOTS] if experiment.unseen else ()


def _with_radius_only(task: TaskSettings, radius: float, duration_s: float) -> TaskSettings:
    """Return the task with this radius in counts, taught in phase 1 only for `duration_s`."""
    learning = task.learning.model_copy(update={"radius": radius})
    teaching = task.teaching.model_copy(update={"supervised_s": duration_s, "corrections_s": 0.0})
    return task.model_copy(update={"learning": learning, "teaching": teaching})


def _chosen(paper: PaperSettings, extent: Extent, tasks: Sequence[str]) -> list[ExperimentSettings]:
    if tasks:
        # By their files, since a path may lead to a shipped one.
        known = {_file_of(each.task): each for each in paper.experiments}
        asked = {_file_of(name): ExperimentSettings(task=name, title=Path(name).stem) for name in tasks}
        return [known.get(file, own) for file, own in asked.items()]
    return [each for each in paper.experiments if extent.tasks is None or each.task in extent.tasks]


def _file_of(task: str) -> Path:
    return find_config("tasks", task).resolve()


def _require_tasks(chosen: Sequence[ExperimentSettings], parts: JobParts) -> None:
    loaded = [(each, load_task(each.task)) for each in chosen]
    names = [task.name for _, task in loaded]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise StudyError(f"two tasks have the name {', '.join(twice)}", do="give one of them another name in its file")
    for each, task in loaded:
        nowhere = sorted(set(each.asked.success_at_least) - set(task.exam.worlds))
        if nowhere:
            raise StudyError(
                f"success is asked in {', '.join(nowhere)}, but its exams are in {', '.join(task.exam.worlds)}",
                where=task.name,
            )
    for each, task in loaded:
        generated = each.unseen.names if each.unseen else ()
        require_metric(parts["factory"], task, (task.teaching.world, *task.exam.worlds, *generated))


class Experiment(NamedTuple):
    """Key of a group of robots: a task in one reading of the paper, the shipped or the plain one."""

    settings: ExperimentSettings
    reading: Reading
    task: TaskSettings

    @property
    def label(self) -> str:
        """Label of the task in tables."""
        return self.task.name.replace("_", " ")


Examined = Group[Experiment, ExaminedOutcome]
"""Robots of one experiment."""


class GrowthStudy(NamedTuple):
    """Curves of Fig. 2 in one reading: the number of RLAs over time, for each radius R."""

    reading: Reading
    task: str
    curves: dict[float, list[tuple[int, ...]]]
    """Number of RLAs after each second, a curve for each robot, by R in counts, in rising order."""


@dataclass(frozen=True, slots=True)
class PaperStudy:
    """Stored outcomes of the paper study, grouped for its tables and figures, with their plan."""

    plan: StudyPlan[PaperExtent]
    experiments: tuple[Examined, ...]
    growth: tuple[GrowthStudy, ...]
    """Empty when its task is not among those to be done."""

    @property
    def readings(self) -> tuple[Reading, ...]:
        """Readings in the order of the report."""
        return tuple(dict.fromkeys(each.of.reading for each in self.experiments))

    def of(self, reading: Reading) -> tuple[Examined, ...]:
        """Return the experiments in one reading."""
        return tuple(each for each in self.experiments if each.of.reading == reading)


def read_study(plan: StudyPlan[PaperExtent]) -> PaperStudy:
    """Read the results of all jobs of the plan. Raises StudyError if a result is missing or damaged."""
    jobs = plan.of(TaughtJob)
    experiments = read_groups(jobs, lambda job: Experiment(job.settings, job.reading, job.task), ExaminedOutcome)
    grown = read_groups(plan.of(GrowthJob), lambda job: (job.reading, job.task.name, job.radius), GrowthOutcome)
    growth = tuple(
        GrowthStudy(of.of[0], of.of[1], {each.of[2]: [robot.growth for robot in each.rows] for each in of.rows})
        for of in group_by(sorted(grown, key=lambda each: each.of[2]), lambda each: each.of[:2])
    )
    return PaperStudy(plan, experiments, growth)
