"""Teaches a route to a robot that knows the streets, and examines it there."""

from collections.abc import Iterable
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

from behaviors.metrics.route import RouteSettings
from behaviors.metrics.routes import Route
from behaviors.metrics.task_metric import JUNCTIONS, RIGHT
from hal.robot_settings import RobotSettings
from hal.settings import SettingsError
from hal.simulation import Position, SimulationFactory
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.curriculum import Report, run_lesson
from kurt2rt.experiments.lockstep.exam import ExamResult, ExamSetup, examine
from kurt2rt.experiments.lockstep.lesson import TrainingResult
from kurt2rt.experiments.lockstep.lesson_plan import LessonPlan
from kurt2rt.experiments.route.outcome import Place, RouteDrive, RouteOutcome, Wrong
from kurt2rt.experiments.route.route_monitor import RouteMonitor
from kurt2rt.experiments.route.variants import Variant
from kurt2rt.experiments.study.provenance import Provenance

_PLACE_STRIDE = 2
"""Points of a drive's trail from one that is kept to the next: 0.2 s."""


@dataclass(frozen=True, slots=True)
class TaughtRoute:
    """A lesson and its exam."""

    route: Route
    lessons: tuple[TrainingResult, ...]
    """Its parts, one after the other."""
    exam: ExamResult
    wrong: tuple[Wrong, ...]

    def outcome(self, made_of: Provenance | None = None) -> RouteOutcome:
        """Return the outcome to store, of the training run and the exam; `made_of`: its provenance, if known."""
        last, exam, legs = self.lessons[-1], self.exam, self.route.legs

        def of_all(name: str) -> int:
            return sum(getattr(each, name) for each in self.lessons)

        return RouteOutcome(
            made_of=made_of,
            seed=last.seed,
            route=tuple((leg.junction.x_m, leg.junction.y_m) for leg in legs),
            start=(legs[0].middle.x_m, legs[0].middle.y_m),
            teaching_s=sum(each.teaching_s for each in self.lessons),
            mid_rlas=len(last.mid_rlas),
            basic_rlas=len(last.rlas),
            mid_asks=of_all("mid_asks"),
            mid_corrections=of_all("mid_corrections"),
            missed_junctions=of_all("missed_junctions"),
            asks=of_all("asks") - of_all("mid_asks"),
            corrections=of_all("corrections"),
            rescues=of_all("rescues"),
            knowledge_hash=last.knowledge_hash,
            drive=RouteDrive(
                duration_s=exam.duration_s,
                junctions=round(exam.findings[JUNCTIONS]),
                right=round(exam.findings[RIGHT]),
                wrong=self.wrong,
                collisions=exam.collisions,
                stuck=exam.stuck,
                alarm=exam.alarm,
                share_unknown=exam.share_unknown,
                way_m=exam.distance_travelled_m,
                trail=_places(exam.trail[::_PLACE_STRIDE]),
                collided_at=_places(exam.collision_positions),
            ),
        )


async def teach_route(
    factory: SimulationFactory,
    settings: RobotSettings,
    task: TaskSettings,
    variant: Variant,
    knowledge: Path,
    *,
    seed: int,
    report: Report,
) -> TaughtRoute:
    """Teach the task's route into a file that holds the streets, and examine it.

    Args:
        factory: opens the simulations.
        settings: of the robot.
        task: with the route.
        variant: way of teaching.
        knowledge: path of the file.
        seed: of robot and teacher.
        report: progress callback.

    Raises:
        KnowledgeError: the file cannot be used.
        SettingsError: the task teaches no route, or does not fit the world.
        LessonLostError: the robot refused a command, or a lesson was not stored.
    """
    task = variant.task(task)
    world = task.exam.worlds[0]
    lessons = []
    for plan in variant.plans(task, route_of_task(task).starts):
        lesson, events = await run_lesson(
            factory, settings, task, knowledge, seed=seed, report=_named(report, plan), plan=plan
        )
        lessons.append(lesson)
    watching = RouteMonitor()
    with closing(factory.open(world, seed, "exam of a route")) as simulation:
        exam = await examine(
            simulation,
            settings,
            task,
            events,
            ExamSetup(world, seed, on_tick=watching.on_tick),
            lambda done_s: report("exam without teacher", done_s, task.exam.duration_s),
        )
    watching.end()
    route = route_of_task(task).route_in(factory.plan_of(world), task.behaviours)
    return TaughtRoute(route, tuple(lessons), exam, tuple(watching.wrong))


def route_of_task(task: TaskSettings) -> RouteSettings:
    """Return the settings of a task's route. Raises hal.settings.SettingsError for a task without one."""
    if isinstance(task.course, RouteSettings):
        return task.course
    raise SettingsError(f"its course is {task.course.kind}, and there is no route to teach", where=f"task {task.name}")


def with_route(task: TaskSettings, seed: int, decisions: int | None = None) -> TaskSettings:
    """Return the task with the route of this robot, unless it names one; `decisions`: None: the task's number.

    Raises hal.settings.SettingsError for a task that teaches no route.
    """
    course = route_of_task(task)
    update: dict[str, object] = {"seed": seed if course.seed is None else course.seed}
    if decisions is not None:
        update["decisions"] = decisions
    return task.model_copy(update={"course": course.model_copy(update=update)})


def _named(report: Report, plan: LessonPlan) -> Report:
    """Each part of a lesson has a bar of its own."""
    return lambda what, done_s, whole_s: report(f"{what}: {plan.purpose}", done_s, whole_s)


def _places(positions: Iterable[Position]) -> tuple[Place, ...]:
    return tuple((round(each.x_m, 3), round(each.y_m, 3)) for each in positions)
