"""Lesson of a rival: the training run of every robot, with marks after given numbers of presses."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from hal.batch_lesson import LessonCause, LessonFactory
from hal.robot_settings import RobotSettings
from hal.simulation import Simulation
from kurt2rt.core.decision.decision import DecisionCause
from kurt2rt.core.event_store import InMemoryEventStore
from kurt2rt.core.learner.learner_team import LearnerTeam
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.experiments.lockstep.batch_lesson import open_batch_lesson
from kurt2rt.experiments.lockstep.lesson import TrainingResult, TrainingRun
from kurt2rt.experiments.lockstep.lesson_plan import LessonPlan, plan_of
from kurt2rt.experiments.lockstep.runtimes import TrainingStore, build_training_runtime
from kurt2rt.experiments.rivals.marks import Mark, PressMarks
from kurt2rt.runtime import Runtime
from kurt2rt.teacher.scripted.basic_teacher import BasicTeacher


@dataclass(frozen=True, slots=True)
class RivalLesson:
    """Lesson of one robot."""

    result: TrainingResult
    marks: tuple[Mark, ...]
    """Marks after the numbers of presses asked for, ascending; the last one is at the end of the lesson."""
    driven_s: float
    """Time in which the teacher drove the robot by a held action or by hand."""
    waited_s: float
    """Time in which the robot stood and asked."""


async def teach_rival(
    simulation: Simulation,
    settings: RobotSettings,
    task: TaskSettings,
    team: LearnerTeam | None,
    after: Sequence[int],
    *,
    seed: int,
    on_progress: Callable[[float], None],
    plan: LessonPlan | None = None,
) -> tuple[RivalLesson, Runtime]:
    """Give the task's lesson, or that of another plan; return it with the runtime that was taught.

    Args:
        simulation: that the robot drives in.
        settings: of the robot.
        task: to teach.
        team: learners to teach; None: the RLAs.
        after: numbers of presses after which the knowledge is marked, ascending.
        seed: random choices of the teacher.
        on_progress: called once a second with the simulated seconds.
        plan: None: the task's own, phases 1 and 2.

    Raises:
        LessonLostError: the robot refused a command.
        hal.settings.SettingsError: task and world do not fit.
    """
    store, plan = InMemoryEventStore(), plan or plan_of(task)
    training = TrainingStore(store, learners=team)
    runtime = build_training_runtime(simulation, settings, task, training, appraises=plan.appraises)
    run = MarkedRun(simulation, runtime, store, team, after, seed=seed, on_progress=on_progress, plan=plan)
    await run.drive()
    return run.lesson(), runtime


def teach_rival_in_batch(
    factory: LessonFactory,
    settings: RobotSettings,
    task: TaskSettings,
    team: LearnerTeam | None,
    after: Sequence[int],
    *,
    seed: int,
    on_progress: Callable[[float], None],
) -> tuple[RivalLesson, Runtime] | None:
    """Give the task's lesson in a batch, as `teach_rival` does; return None if it belongs on the CAN bus.

    The learners have then been taught a part of it. `factory` opens the simulation; for the rest see `teach_rival`.

    Raises:
        BatchRefusedError: the batch does not know the task or its teacher, or a learner failed.
        LessonLostError: the robot refused a command.
        hal.settings.SettingsError: task and world do not fit.
    """
    with open_batch_lesson(factory, settings, task, seed=seed, on_progress=on_progress, learners=team) as run:
        pressed = PressMarks(after, lambda: run.events, team)
        run.on_stretch = lambda: pressed.update(run.presses, run.ticks * run.period_s)
        if not run.drive_stretches():
            return None
        causes = run.robot.log.causes[1 : run.ticks + 1]
        driven_s, waited_s = (
            int((causes == cause).sum()) * run.period_s for cause in (LessonCause.TEACHER, LessonCause.UNKNOWN)
        )
        marks = pressed.at_end(run.presses, run.ticks * run.period_s)
        return RivalLesson(run.result(), marks, driven_s, waited_s), run.runtime


def session_of(plan: LessonPlan, seed: int) -> str:
    """Return the prefix of the command ids of a robot's lesson."""
    return f"{plan.purpose}-{seed}-after-0"


class MarkedRun(TrainingRun):
    """Training run that marks the knowledge before the press that follows each of `after`."""

    def __init__(
        self,
        simulation: Simulation,
        runtime: Runtime,
        store: InMemoryEventStore,
        team: LearnerTeam | None,
        after: Sequence[int],
        *,
        seed: int,
        on_progress: Callable[[float], None],
        plan: LessonPlan | None = None,
        answering: BasicTeacher | None = None,
    ) -> None:
        """Begin the run; `plan` and `answering`: None: the task's own."""
        plan = plan or plan_of(runtime.task)
        super().__init__(
            simulation,
            runtime,
            plan,
            seed=seed,
            session=session_of(plan, seed),
            on_progress=on_progress,
            answering=answering,
        )
        self._pressed = PressMarks(after, lambda: store.events, team)
        self._driven_ticks = self._waiting_ticks = 0

    def on_tick(self, record: TickRecord) -> None:
        """Let the teacher react, and mark the knowledge."""
        super().on_tick(record)
        decision = record.decision
        self._driven_ticks += decision.cause is DecisionCause.TEACHER
        self._waiting_ticks += decision.asking
        self._pressed.update(self.presses, record.tick * self.period_s)

    def lesson(self) -> RivalLesson:
        """Return the result with the marks."""
        return RivalLesson(
            self.result(),
            self._pressed.at_end(self.presses, self.ticks * self.period_s),
            self._driven_ticks * self.period_s,
            self._waiting_ticks * self.period_s,
        )
