"""Route study: robots learn the streets, then routes of each length by each variant, and are examined there."""

from collections.abc import Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from config.settings import SettingsError
from kurt2rt.core.rla.rla import Phase
from kurt2rt.core.task_settings import TaskSettings, load_task, taught_by
from kurt2rt.experiments.lockstep.compatibility import route_of_task, with_route
from kurt2rt.experiments.lockstep.curriculum import Report
from kurt2rt.experiments.lockstep.drive_row import DriveRow, ExamVerdict, Place
from kurt2rt.experiments.lockstep.exam import ExamSetup, examine
from kurt2rt.experiments.lockstep.lesson_plan import LessonPlan, plan_of
from kurt2rt.experiments.route.route_monitor import RouteMistake, RouteMonitor
from kurt2rt.experiments.study.jobs import JobParts, StudyError, StudyJob, TaughtOutcome, require_places
from kurt2rt.experiments.study.provenance import Fingerprints
from kurt2rt.experiments.study.study_plan import Group, StudyPlan
from kurt2rt.knowledge.journal.loading import copy_knowledge, read_lessons


class RouteOutcome(TaughtOutcome):
    """Stored outcome of a robot that was taught one route and examined on it."""

    route: tuple[Place, ...]
    """Its junctions, from the first decision on."""
    drive: DriveRow
    """Exam; passed if every decision was right, without a collision, to the end."""
    wrong: tuple[RouteMistake, ...]
    """Decisions that were not right."""


Routes = Group[int, RouteOutcome]
"""Robots that were taught routes of one number of decisions."""


@dataclass(frozen=True, slots=True, kw_only=True)
class BasicJob(StudyJob):
    """Job in which a robot learns to drive in streets, before other jobs teach it routes."""

    outcome = TaughtOutcome

    async def measure(self, knowledge: Path, report: Report) -> TaughtOutcome:
        """Teach the streets into the file `knowledge` and return the outcome."""
        lesson, _ = await self.teach(knowledge, report)
        return TaughtOutcome(made_of=self.made_of, seed=self.seed, lesson=lesson.counts)


@dataclass(frozen=True, slots=True, kw_only=True)
class RouteJob(StudyJob):
    """Job that teaches one robot a route on top of its knowledge of the streets, and examines it there."""

    outcome = RouteOutcome
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
        task = self.task
        metric, world = route_of_task(task), task.exam.worlds[0]
        lessons = []
        for plan in lesson_plans(task, metric.starts):
            lesson, events = await self.teach(knowledge, _named(report, plan), plan=plan)
            lessons.append(lesson)
        watching = RouteMonitor()
        with closing(self.factory.open(world, self.seed, "exam of a route")) as simulation:
            exam = await examine(
                simulation,
                self.robot,
                task,
                ExamSetup(world, self.seed, events=events, on_tick=watching.on_tick),
                lambda done_s: report("exam without teacher", done_s, task.exam.duration_s),
            )
        watching.end()
        legs = metric.route_in(self.factory.plan_of(world), task.behaviours).legs

        summed = ("teaching_s", "asks", "corrections", "rescues", "mid_asks", "mid_corrections", "missed_junctions")
        counts = {name: sum(getattr(each.counts, name) for each in lessons) for name in summed}
        counts["asks"] -= counts["mid_asks"]
        return RouteOutcome(
            made_of=self.made_of,
            seed=self.seed,
            lesson=lessons[-1].counts.model_copy(update=counts),
            route=tuple((leg.junction.x_m, leg.junction.y_m) for leg in legs),
            drive=exam.with_verdict(ExamVerdict.FAILED) if watching.wrong else exam.as_measure(),
            wrong=tuple(watching.wrong),
        )


def lesson_plans(task: TaskSettings, starts: int) -> tuple[LessonPlan, ...]:
    """Return one plan for each start, in order: the task's whole lesson, cut into parts of equal length.

    Each part continues the phases where the part before ended. `starts`: number of parts.
    """
    whole = plan_of(task)
    part_s = whole.duration_s / starts
    return tuple(
        LessonPlan(_part(whole.phases, part * part_s, (part + 1) * part_s), purpose=f"route-{part + 1}")
        for part in range(starts)
    )


def _part(phases: tuple[tuple[Phase, float], ...], from_s: float, to_s: float) -> tuple[tuple[Phase, float], ...]:
    """Return the phases between two times in s."""
    part, begins_s = [], 0.0
    for phase, lasts_s in phases:
        ends_s = begins_s + lasts_s
        within_s = min(ends_s, to_s) - max(begins_s, from_s)
        if within_s > 0:
            part.append((phase, within_s))
        begins_s = ends_s
    return tuple(part)


def _named(report: Report, plan: LessonPlan) -> Report:
    """Each part of a lesson has a bar of its own."""
    return lambda what, done_s, whole_s: report(f"{what}: {plan.purpose}", done_s, whole_s)


class RouteTasks(NamedTuple):
    """Subject of the route study: the task of the routes, and the task that teaches the streets before."""

    task: TaskSettings
    """Task without the route, which each robot's seed draws."""
    basic: TaskSettings
    """Task that teaches the streets."""


def make_plan(
    task: TaskSettings,
    seeds: Sequence[int],
    decisions: Sequence[int],
    parts: JobParts,
    *,
    basic_folder: Path | None = None,
) -> StudyPlan[RouteTasks]:
    """Check tasks, worlds and routes, and return the jobs, a robot for each seed and length.

    `decisions`: lengths of the routes; empty: the task's own. `basic_folder`: knowledge files of the streets; None: the
    streets are taught first. Raises config.settings.SettingsError, StudyError for a missing file, KnowledgeError.
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
            made_of=fingerprints.of(routes[seed, count], worlds, streets.made_of[seed]),
            name=f"{task.name} of {count}, seed {seed}",
            stem=f"{task.name}-{count}-{seed}",
            robot_time_s=task.teaching.duration_s + task.exam.duration_s,
            wave=1,
            basic=streets.files[seed],
        )
        for count in lengths
        for seed in seeds
    )
    return StudyPlan(RouteTasks(task, basic), tuple(seeds), (*streets.jobs, *jobs))


class TaughtStreets(NamedTuple):
    """Knowledge files of robots that can drive in streets, and the jobs that make those which are missing."""

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

    `folder`: files as `kurt2rt train` leaves them, which are used instead of jobs; None: the streets are taught. Raises
    StudyError, KnowledgeError, SettingsError.
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

    Raises config.settings.SettingsError if there is no such task.
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
