"""Lesson of a rival: the training run of every robot, with marks after given numbers of presses."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from hal.robot_settings import RobotSettings
from hal.simulation import Simulation
from kurt2rt.core.decision.decision import DecisionCause
from kurt2rt.core.event_store import InMemoryEventStore
from kurt2rt.core.learner.learner import Label, Signal
from kurt2rt.core.learner.learner_team import LearnerTeam
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.experiments.lockstep.lesson import TrainingResult, TrainingRun
from kurt2rt.experiments.lockstep.lesson_plan import LessonPlan, plan_of
from kurt2rt.experiments.lockstep.runtimes import TrainingStore, build_training_runtime
from kurt2rt.runtime import Runtime
from kurt2rt.teacher.scripted.basic_teacher import BasicTeacher


@dataclass(frozen=True, slots=True)
class Mark:
    """Knowledge after a number of presses."""

    presses: int
    """Number asked for; a robot that gave cause for fewer has all that it was taught."""
    events: tuple[TeachingEvent, ...]
    """Lessons so far, which are the knowledge of RLAs."""
    lessons: tuple[Label | Signal, ...]
    """Standing labels and rewards so far, which are the knowledge of a learner; empty for RLAs."""
    teaching_s: float


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
        self._store, self._team, self._after = store, team, after
        self._marks: list[Mark] = []
        self._driven_ticks = self._waiting_ticks = 0

    def on_tick(self, record: TickRecord) -> None:
        """Let the teacher react; mark the knowledge if a press too many was sent, which a later tick applies."""
        super().on_tick(record)
        decision = record.decision
        self._driven_ticks += decision.cause is DecisionCause.TEACHER
        self._waiting_ticks += decision.asking
        presses = len(self._workload.press_ticks)
        while len(self._marks) < len(self._after) and presses > self._after[len(self._marks)]:
            self._marks.append(self._mark(self._after[len(self._marks)]))

    def lesson(self) -> RivalLesson:
        """Return the result with the marks; those that were not reached are of the end."""
        last = self._mark(len(self._workload.press_ticks))
        missing = (self._mark(presses) for presses in self._after[len(self._marks) :])
        return RivalLesson(
            self.result(),
            (*self._marks, *missing, last),
            self._driven_ticks * self.period_s,
            self._waiting_ticks * self.period_s,
        )

    def _mark(self, presses: int) -> Mark:
        lessons = () if self._team is None else self._team.lessons
        return Mark(presses, tuple(self._store.events), lessons, self.ticks * self.period_s)
