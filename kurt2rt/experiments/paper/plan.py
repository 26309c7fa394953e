"""Plan of the paper study: a job for each experiment, reading and seed."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from hal.robot_settings import RobotSettings
from hal.settings_files import find_config
from hal.simulation import SimulationFactory
from kurt2rt.core.phase_settings import PHASES
from kurt2rt.core.task_settings import TaskSettings, load_task, taught_by_named
from kurt2rt.experiments.lockstep.compatibility import require_course
from kurt2rt.experiments.paper.extent import Extent
from kurt2rt.experiments.paper.jobs import GrowthJob, TaughtJob, with_radius_only
from kurt2rt.experiments.paper.outcome import Reading
from kurt2rt.experiments.paper.settings import AskedSettings, ExperimentSettings, PaperSettings
from kurt2rt.experiments.study.eligibility import ROBOTS
from kurt2rt.experiments.study.jobs import JobParts, StudyJob
from kurt2rt.experiments.study.loop_choice import ALL_ON_BUS, NO_CHOICE, LoopChoice, RequestedLoops, choose_loops
from kurt2rt.experiments.study.provenance import Fingerprints
from kurt2rt.experiments.study.results import StudyError


@dataclass(frozen=True, slots=True)
class PaperExperiment:
    """One task in one reading: a job per seed."""

    settings: ExperimentSettings
    reading: Reading
    task: TaskSettings
    jobs: tuple[TaughtJob, ...]


@dataclass(frozen=True, slots=True)
class Growth:
    """Fig. 2 in one reading: a job per radius and seed."""

    reading: Reading
    task: TaskSettings
    jobs: tuple[GrowthJob, ...]


@dataclass(frozen=True, slots=True)
class PaperPlan:
    """Jobs of the study, in the order of the report."""

    paper: PaperSettings
    extent: Extent
    seeds: tuple[int, ...]
    experiments: tuple[PaperExperiment, ...]
    growth: tuple[Growth, ...]
    """Empty when its task is not among those to be done."""
    choice: LoopChoice = NO_CHOICE
    """Loops of the jobs."""

    @property
    def waves(self) -> tuple[tuple[StudyJob, ...], ...]:
        """All jobs and witnesses in one wave: no job needs another."""
        return ((*self.jobs, *self.choice.witnesses(self.jobs)),)

    @property
    def jobs(self) -> list[TaughtJob | GrowthJob]:
        """All jobs of the study, in the order of the report, without witnesses."""
        return [
            *(job for experiment in self.experiments for job in experiment.jobs),
            *(job for growth in self.growth for job in growth.jobs),
        ]

    def driven(self, loops: RequestedLoops, robot: RobotSettings) -> "PaperPlan":
        """Return the plan with jobs that these loops drive. Raises hal.settings.SettingsError."""
        choice = choose_loops(self.jobs, loops, robot)
        return replace(
            self,
            experiments=tuple(replace(each, jobs=choice.apply(each.jobs)) for each in self.experiments),
            growth=tuple(replace(each, jobs=choice.apply(each.jobs)) for each in self.growth),
            choice=choice,
        )

    def experiments_of(self, reading: Reading) -> tuple[PaperExperiment, ...]:
        """Return the experiments of one reading."""
        return tuple(each for each in self.experiments if each.reading == reading)


def make_plan(
    paper: PaperSettings,
    extent: Extent,
    seeds: Sequence[int],
    readings: Sequence[Reading],
    parts: JobParts,
    *,
    tasks: Sequence[str] = (),
    loops: RequestedLoops = ALL_ON_BUS,
) -> PaperPlan:
    """Check every task and world, and return the jobs.

    Args:
        paper: settings of the study.
        extent: limits of tasks, worlds and times.
        seeds: one robot each.
        readings: readings of the paper to study.
        parts: factory, robot and results of the jobs.
        tasks: names or paths; empty: all. A task without an experiment in `paper` has no targets.
        loops: requested for lessons and exams.

    Raises:
        hal.settings.SettingsError: a task and a world do not fit.
        StudyError: two tasks have one name, or a target has no exam.
    """
    factory, robot = parts["factory"], parts["robot"]
    paper = extent.paper(paper)
    chosen = _chosen(paper, extent, tasks)
    _require_tasks(chosen, factory)
    taught = [
        (each, reading, taught_by_named(extent.task(load_task(each.task, plain=reading == "plain")), paper.teacher))
        for reading in readings
        for each in chosen
    ]
    fingerprints = Fingerprints(factory, robot, ("paper", "plain", *PHASES))
    maker = _JobMaker(paper, tuple(seeds), parts, fingerprints)
    plan = PaperPlan(
        paper,
        extent,
        maker.seeds,
        tuple(maker.experiment(*each) for each in taught),
        tuple(maker.growth(reading, task) for each, reading, task in taught if each.task == paper.growth.task),
    )
    return plan.driven(loops, robot)


@dataclass(frozen=True, slots=True)
class _JobMaker:
    """Maker of the jobs of one study."""

    paper: PaperSettings
    seeds: tuple[int, ...]
    parts: JobParts
    fingerprints: Fingerprints

    def experiment(self, settings: ExperimentSettings, reading: Reading, task: TaskSettings) -> PaperExperiment:
        """Return the jobs of one task in one reading: one job per seed."""
        jobs = []
        for seed in self.seeds:
            own = unseen_of(seed, settings)
            made = self.fingerprints.of(task, (task.teaching.world, *task.exam.worlds, *own))
            jobs.append(TaughtJob(task=task, reading=reading, seed=seed, unseen=own, made_of=made, **self.parts))
        return PaperExperiment(settings, reading, task, tuple(jobs))

    def growth(self, reading: Reading, task: TaskSettings) -> Growth:
        """Return the jobs of Fig. 2 in one reading: one job per radius and seed."""
        jobs, growth = [], self.paper.growth
        for radius in growth.radii:
            of_radius = with_radius_only(task, radius, growth.duration_s)
            made = self.fingerprints.of(of_radius, (task.teaching.world,))
            for seed in self.seeds[: growth.robots]:
                jobs.append(GrowthJob(task=of_radius, reading=reading, seed=seed, made_of=made, **self.parts))
        return Growth(reading, task, tuple(jobs))


def unseen_of(seed: int, experiment: ExperimentSettings) -> tuple[str, ...]:
    """Return the names of the generated worlds of one seed; 20 successive seeds share all of them."""
    return experiment.unseen.names[seed % ROBOTS :: ROBOTS] if experiment.unseen else ()


def _chosen(paper: PaperSettings, extent: Extent, tasks: Sequence[str]) -> list[ExperimentSettings]:
    if tasks:
        # By their files, since a path may lead to a shipped one.
        known = {_file_of(each.task): each for each in paper.experiments}
        asked = {_file_of(name): ExperimentSettings(task=name, title=Path(name).stem) for name in tasks}
        return [known.get(file, own) for file, own in asked.items()]
    return [each for each in paper.experiments if extent.tasks is None or each.task in extent.tasks]


def _require_tasks(chosen: Sequence[ExperimentSettings], factory: SimulationFactory) -> None:
    loaded = {each.task: load_task(each.task) for each in chosen}
    names = [task.name for task in loaded.values()]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise StudyError(f"two tasks have the name {', '.join(twice)}", do="give one of them another name in its file")
    for each in chosen:
        _require_exams_in(each.asked, loaded[each.task])
    for each in chosen:
        task = loaded[each.task]
        generated = each.unseen.names if each.unseen else ()
        require_course(factory, task, (task.teaching.world, *task.exam.worlds, *generated))


def _file_of(task: str) -> Path:
    return find_config("tasks", task).resolve()


def _require_exams_in(asked: AskedSettings, task: TaskSettings) -> None:
    nowhere = sorted(set(asked.success_at_least) - set(task.exam.worlds))
    if nowhere:
        raise StudyError(
            f"success is asked in {', '.join(nowhere)}, but its exams are in {', '.join(task.exam.worlds)}",
            where=task.name,
        )
