"""Plan of the route study: the streets of each robot, then a job for each length and variant."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from hal.robot_settings import RobotSettings
from hal.settings import SettingsError
from hal.simulation import SimulationFactory
from kurt2rt.core.task_settings import TaskSettings, load_task, taught_by
from kurt2rt.experiments.lockstep.compatibility import require_course
from kurt2rt.experiments.route.jobs import BasicJob, RouteJob
from kurt2rt.experiments.route.lesson import route_of_task, with_route
from kurt2rt.experiments.route.variants import Variant
from kurt2rt.experiments.study.jobs import JobParts
from kurt2rt.experiments.study.provenance import Fingerprints
from kurt2rt.experiments.study.results import Results, StudyError
from kurt2rt.knowledge.journal.loading import read_lessons


@dataclass(frozen=True, slots=True)
class RouteExperiment:
    """Routes of one length and variant: a job for each seed."""

    decisions: int
    variant: Variant
    jobs: tuple[RouteJob, ...]


@dataclass(frozen=True, slots=True)
class RoutePlan:
    """Jobs of the study, in the order of the report."""

    task: TaskSettings
    """Task without the route, which each robot's seed draws."""
    basic: TaskSettings
    seeds: tuple[int, ...]
    basic_jobs: tuple[BasicJob, ...]
    """Empty where the streets were taught before."""
    experiments: tuple[RouteExperiment, ...]

    @property
    def waves(self) -> tuple[tuple[BasicJob | RouteJob, ...], ...]:
        """Jobs in waves; the jobs of a wave need only results of earlier waves."""
        return self.basic_jobs, tuple(job for each in self.experiments for job in each.jobs)

    @property
    def jobs(self) -> list[BasicJob | RouteJob]:
        """Jobs of all waves, in order."""
        return [job for wave in self.waves for job in wave]


def make_plan(
    task: TaskSettings,
    basic: TaskSettings,
    seeds: Sequence[int],
    decisions: Sequence[int],
    variants: Sequence[Variant],
    parts: JobParts,
    *,
    basic_folder: Path | None = None,
) -> RoutePlan:
    """Check tasks, worlds and routes, and return the jobs.

    Args:
        task: that teaches the route.
        basic: the task that teaches the streets.
        seeds: one robot each.
        decisions: lengths of the routes.
        variants: ways of teaching.
        parts: factory, robot and results of the jobs.
        basic_folder: knowledge files of `basic`, by `kurt2rt lesson`; None: the streets are taught first.

    Raises:
        hal.settings.SettingsError: a task and a world do not fit.
        StudyError: a knowledge file is missing.
        KnowledgeError: a knowledge file cannot be read.
    """
    factory, robot, results = parts["factory"], parts["robot"], parts["results"]
    worlds = (task.teaching.world, *task.exam.worlds[:1])
    factory.require_worlds(*worlds, basic.teaching.world)
    routes = {(seed, count): with_route(task, seed, count) for seed in seeds for count in decisions}
    for each in routes.values():
        require_course(factory, each, worlds)
    fingerprints = Fingerprints(factory, robot, ("paper", "plain", "phases"))
    streets = streets_of(basic, seeds, factory, robot, results, fingerprints, basic_folder)

    def experiment(count: int, variant: Variant) -> RouteExperiment:
        jobs = []
        for seed in seeds:
            own = routes[seed, count]
            made = fingerprints.of(variant.task(own), worlds, streets.made_of[seed], repr(variant))
            basic_file = streets.files[seed]
            jobs.append(RouteJob(task=own, variant=variant, seed=seed, basic=basic_file, made_of=made, **parts))
        return RouteExperiment(count, variant, tuple(jobs))

    return RoutePlan(
        task,
        basic,
        tuple(seeds),
        streets.jobs,
        tuple(experiment(count, variant) for variant in variants for count in decisions),
    )


class TaughtStreets(NamedTuple):
    """Knowledge of the streets, which robots have before a route."""

    jobs: tuple[BasicJob, ...]
    """Empty where they were taught already."""
    files: dict[int, Path]
    """Knowledge of each seed."""
    made_of: dict[int, str]
    """Provenance or content of the knowledge, by seed."""


def streets_of(
    basic: TaskSettings,
    seeds: Sequence[int],
    factory: SimulationFactory,
    robot: RobotSettings,
    results: Results,
    fingerprints: Fingerprints,
    folder: Path | None,
) -> TaughtStreets:
    """Return the jobs that teach the streets, and the knowledge file of each robot.

    `folder`: files as `kurt2rt lesson` leaves them, which are used instead of jobs; None: the streets are taught.

    Raises:
        StudyError: a knowledge file is missing.
        KnowledgeError: a knowledge file cannot be read.
        SettingsError: a task and a world do not fit.
    """
    if folder is not None:
        files = {seed: basic_file(folder, basic, seed) for seed in seeds}
        return TaughtStreets((), files, {seed: repr(read_lessons(file, robot, basic)) for seed, file in files.items()})
    made = fingerprints.of(basic, (basic.teaching.world,))
    jobs = tuple(
        BasicJob(factory=factory, robot=robot, task=basic, seed=seed, made_of=made, results=results) for seed in seeds
    )
    return TaughtStreets(jobs, {job.seed: job.knowledge for job in jobs}, dict.fromkeys(seeds, made.model_dump_json()))


def basic_task_of(task: TaskSettings) -> TaskSettings:
    """Return the task that teaches the streets, named by `system` of the route's task, with the same teacher.

    Raises hal.settings.SettingsError if there is no such task.
    """
    if task.system is None:
        raise SettingsError(
            "it does not say what was taught before", where=f"task {task.name}", do="add `system: streets`"
        )
    return taught_by(load_task(task.system), task.teaching.profile)


def basic_file(place: Path, basic: TaskSettings, seed: int) -> Path:
    """Return the file with one robot's knowledge of the streets: `place` itself, or a file in that folder.

    Raises StudyError if there is no such file.
    """
    file = place / f"{basic.name}-{seed}.knowledge" if place.is_dir() else place
    if file.is_file():
        return file
    raise StudyError(
        "there is no such file",
        where=file,
        do=f"teach the streets with kurt2rt lesson --task {basic.name} --seed {seed}, or leave --basic out",
    )


def decisions_of(task: TaskSettings, asked: Sequence[int]) -> tuple[int, ...]:
    """Return the lengths of routes: the requested ones, each once, or the task's own.

    Raises hal.settings.SettingsError for a task without a route.
    """
    return tuple(dict.fromkeys(asked)) or (route_of_task(task).decisions,)
