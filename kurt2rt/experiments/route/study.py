"""Route study: robots learn the streets, then routes of each length by each variant, and are examined there."""

from collections.abc import Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from behaviors.metrics.route import RouteSettings
from hal.settings import SettingsError
from kurt2rt.core.task_settings import TaskSettings, load_task, taught_by
from kurt2rt.experiments.lockstep.curriculum import Report
from kurt2rt.experiments.lockstep.exam import ExamSetup, examine
from kurt2rt.experiments.lockstep.exam_verdict import ExamVerdict
from kurt2rt.experiments.lockstep.lesson_plan import LessonPlan
from kurt2rt.experiments.lockstep.seed_result import counts_of
from kurt2rt.experiments.route.route_monitor import RouteMonitor, Wrong
from kurt2rt.experiments.route.variants import Variant
from kurt2rt.experiments.study.drive_row import DriveRow, Place, row_of
from kurt2rt.experiments.study.jobs import JobParts, StudyJob, TaughtOutcome, require_places
from kurt2rt.experiments.study.provenance import Fingerprints
from kurt2rt.experiments.study.results import StudyError
from kurt2rt.experiments.study.study_plan import StudyPlan
from kurt2rt.knowledge.journal.loading import copy_knowledge, read_lessons


class RouteOutcome(TaughtOutcome):
    """One robot, taught one route and examined on it; its lesson counts the basic level."""

    route: tuple[Place, ...]
    """Its junctions, from the first decision on."""
    mid_rlas: int
    mid_asks: int
    mid_corrections: int
    missed_junctions: int
    """Junctions that the mid level missed in training; the teacher commanded there."""
    drive: DriveRow
    """Exam; passed if every decision was right, without a collision, to the end."""
    wrong: tuple[Wrong, ...]
    """Decisions that were not right."""


@dataclass(frozen=True, slots=True, kw_only=True)
class BasicJob(StudyJob):
    """Training run of the task that teaches the streets."""

    outcome = TaughtOutcome

    async def measure(self, knowledge: Path, report: Report) -> TaughtOutcome:
        """Teach the streets into the file `knowledge` and return the outcome."""
        lesson, _ = await self.teach(knowledge, report)
        return TaughtOutcome(made_of=self.made_of, seed=self.seed, lesson=counts_of(lesson))


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

    async def measure(self, knowledge: Path, report: Report) -> RouteOutcome:
        """Teach the route on top of the streets into the file `knowledge`, examine it and return the outcome."""
        copy_knowledge(self.basic, knowledge)
        return await self.teach_route(knowledge, report)

    async def teach_route(self, knowledge: Path, report: Report) -> RouteOutcome:
        """Teach the route into a file that holds the streets, examine it and return the outcome.

        Raises KnowledgeError, SettingsError, LessonLostError.
        """
        task = self.variant.task(self.task)
        metric, world = route_of_task(task), task.exam.worlds[0]
        lessons = []
        for plan in self.variant.plans(task, metric.starts):
            lesson, events = await self.teach(knowledge, _named(report, plan), task, plan)
            lessons.append(lesson)
        watching = RouteMonitor()
        with closing(self.factory.open(world, self.seed, "exam of a route")) as simulation:
            exam = await examine(
                simulation,
                self.robot,
                task,
                events,
                ExamSetup(world, self.seed, on_tick=watching.on_tick),
                lambda done_s: report("exam without teacher", done_s, task.exam.duration_s),
            )
        watching.end()
        legs = metric.route_in(self.factory.plan_of(world), task.behaviours).legs

        def of_all(name: str) -> int:
            return sum(getattr(each, name) for each in lessons)

        counts = {
            "teaching_s": sum(each.teaching_s for each in lessons),
            "asks": of_all("asks") - of_all("mid_asks"),
            "corrections": of_all("corrections"),
            "rescues": of_all("rescues"),
        }
        return RouteOutcome(
            made_of=self.made_of,
            seed=self.seed,
            lesson=counts_of(lessons[-1]).model_copy(update=counts),
            route=tuple((leg.junction.x_m, leg.junction.y_m) for leg in legs),
            mid_rlas=len(lessons[-1].mid_rlas),
            mid_asks=of_all("mid_asks"),
            mid_corrections=of_all("mid_corrections"),
            missed_junctions=of_all("missed_junctions"),
            drive=row_of(
                exam, ExamVerdict.FAILED if watching.wrong or exam.failed else ExamVerdict.PASSED, trails=True
            ),
            wrong=tuple(watching.wrong),
        )


def _named(report: Report, plan: LessonPlan) -> Report:
    """Each part of a lesson has a bar of its own."""
    return lambda what, done_s, whole_s: report(f"{what}: {plan.purpose}", done_s, whole_s)


def route_of_task(task: TaskSettings) -> RouteSettings:
    """Return the settings of a task's route. Raises hal.settings.SettingsError for a task without one."""
    if isinstance(task.metric, RouteSettings):
        return task.metric
    raise SettingsError(f"its metric is {task.metric.kind}, and there is no route to teach", where=f"task {task.name}")


def with_route(task: TaskSettings, seed: int, decisions: int | None = None) -> TaskSettings:
    """Return the task with the route of this robot, unless it names one; `decisions`: None: the task's number.

    Raises hal.settings.SettingsError for a task that teaches no route.
    """
    metric = route_of_task(task)
    update: dict[str, object] = {"seed": seed if metric.seed is None else metric.seed}
    if decisions is not None:
        update["decisions"] = decisions
    return task.model_copy(update={"metric": metric.model_copy(update=update)})


class RouteTasks(NamedTuple):
    """Task with the routes that are taught."""

    task: TaskSettings
    """Task without the route, which each robot's seed draws."""
    basic: TaskSettings
    """Task that teaches the streets."""


def make_plan(
    task: TaskSettings,
    seeds: Sequence[int],
    decisions: Sequence[int],
    variants: Sequence[Variant],
    parts: JobParts,
    *,
    basic_folder: Path | None = None,
) -> StudyPlan[RouteTasks]:
    """Check tasks, worlds and routes, and return the jobs.

    Args:
        task: that teaches the route.
        seeds: one robot each.
        decisions: lengths of the routes; empty: the task's own.
        variants: ways of teaching.
        parts: factory, robot and results of the jobs.
        basic_folder: knowledge files of the streets, by `kurt2rt train`; None: the streets are taught first.

    Raises:
        hal.settings.SettingsError: a task and a world do not fit.
        StudyError: a knowledge file is missing.
        KnowledgeError: a knowledge file cannot be read.
    """
    basic = basic_task_of(task)
    lengths = tuple(dict.fromkeys(decisions)) or (route_of_task(task).decisions,)
    worlds = (task.teaching.world, *task.exam.worlds[:1])
    parts["factory"].require_worlds(*worlds, basic.teaching.world)
    routes = {(seed, count): with_route(task, seed, count) for seed in seeds for count in lengths}
    for each in routes.values():
        require_places(parts["factory"], each, worlds)
    fingerprints = Fingerprints(parts["factory"], parts["robot"])
    streets = streets_of(basic, seeds, parts, fingerprints, basic_folder)
    jobs = (
        RouteJob(
            **parts,
            task=routes[seed, count],
            seed=seed,
            made_of=fingerprints.of(variant.task(routes[seed, count]), worlds, streets.made_of[seed], repr(variant)),
            name=f"{task.name} of {count}, {variant.name}, seed {seed}",
            stem=f"{variant.name}/{task.name}-{count}-{seed}",
            robot_time_s=task.teaching.duration_s + task.exam.duration_s,
            wave=1,
            variant=variant,
            basic=streets.files[seed],
        )
        for variant in variants
        for count in lengths
        for seed in seeds
    )
    return StudyPlan(RouteTasks(task, basic), tuple(seeds), (*streets.jobs, *jobs))


class TaughtStreets(NamedTuple):
    """Knowledge of the streets, which robots have before a route."""

    jobs: tuple[BasicJob, ...]
    """Empty where they were taught already."""
    files: dict[int, Path]
    """Knowledge of each seed."""
    made_of: dict[int, str]
    """Provenance or content of the knowledge, by seed."""


def streets_of(
    basic: TaskSettings, seeds: Sequence[int], parts: JobParts, fingerprints: Fingerprints, folder: Path | None
) -> TaughtStreets:
    """Return the jobs that teach the streets, and the knowledge file of each robot.

    `folder`: files as `kurt2rt train` leaves them, which are used instead of jobs; None: the streets are taught.

    Raises:
        StudyError: a knowledge file is missing.
        KnowledgeError: a knowledge file cannot be read.
        SettingsError: a task and a world do not fit.
    """
    if folder is not None:
        files = {seed: basic_file(folder, basic, seed) for seed in seeds}
        made_of = {seed: repr(read_lessons(file, parts["robot"], basic)) for seed, file in files.items()}
        return TaughtStreets((), files, made_of)
    made = fingerprints.of(basic, (basic.teaching.world,))
    jobs = tuple(
        BasicJob(
            **parts,
            task=basic,
            seed=seed,
            made_of=made,
            name=f"{basic.name}, seed {seed}",
            stem=f"basic/{basic.name}-{seed}",
            robot_time_s=basic.teaching.duration_s,
        )
        for seed in seeds
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
        do=f"teach the streets with kurt2rt train --task {basic.name} --seed {seed}, or leave --basic out",
    )
