"""Lesson of a rival: the training run of every robot, with marks after given numbers of presses."""

from collections.abc import Awaitable, Callable, Sequence
from contextlib import closing
from dataclasses import dataclass
from typing import TypeVar

from hal.batch_lesson import LessonCause, LessonFactory
from hal.batch_refusal import BatchRefusedError
from hal.robot_settings import RobotSettings
from hal.simulation import Simulation, SimulationFactory
from kurt2rt.core.decision.decision import DecisionCause
from kurt2rt.core.event_store import InMemoryEventStore
from kurt2rt.core.learner.learner_team import LearnerTeam
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.experiments.lockstep.batch_lesson import open_batch_lesson
from kurt2rt.experiments.lockstep.curriculum import Report
from kurt2rt.experiments.lockstep.drive_loop import ON_BUS, DriveLoop, DriveLoops
from kurt2rt.experiments.lockstep.lesson import TrainingResult, TrainingRun
from kurt2rt.experiments.lockstep.lesson_plan import LessonPlan, plan_of
from kurt2rt.experiments.lockstep.runtimes import TrainingStore, build_training_runtime
from kurt2rt.experiments.rivals.marks import Mark, PressMarks
from kurt2rt.runtime import Runtime
from kurt2rt.teacher.scripted.basic_teacher import BasicTeacher

_OutcomeT = TypeVar("_OutcomeT")


@dataclass(frozen=True, slots=True, kw_only=True)
class RivalSetup:
    """Robot that is to be taught, and all that decides its lesson."""

    robot: RobotSettings
    task: TaskSettings
    seed: int
    """Seed of robot and teacher."""
    team: LearnerTeam | None
    """Learners to teach; None: the RLAs."""
    after: tuple[int, ...] = ()
    """Numbers of presses after which the knowledge is marked, ascending."""


@dataclass(frozen=True, slots=True)
class RivalLesson:
    """Lesson of one robot."""

    setup: RivalSetup
    runtime: Runtime
    """Runtime that was taught."""
    result: TrainingResult
    marks: tuple[Mark, ...]
    """Marks after the numbers of presses asked for, ascending; the last one is at the end of the lesson."""
    driven_s: float
    """Time in which the teacher drove the robot by a held action or by hand."""
    waited_s: float
    """Time in which the robot stood and asked."""
    change_ticks: tuple[int, ...]
    """Ticks from each correction of a robot that drove to the first tick of another action."""


OnProgress = Callable[[float], None]
"""Called once a second with the simulated seconds."""
TeachOnBus = Callable[[Simulation, RivalSetup, OnProgress], Awaitable[RivalLesson]]
"""Gives a lesson over the CAN bus."""


async def in_batch_or_on_bus(measure: Callable[[DriveLoops], Awaitable[_OutcomeT]], loops: DriveLoops) -> _OutcomeT:
    """Return what `measure` returns by `loops`; over the CAN bus where a batch refuses the task or a learner failed.

    Raises what `measure` raises, except BatchRefusedError of a batch.
    """
    try:
        return await measure(loops)
    except BatchRefusedError:
        return await measure(ON_BUS)


async def give_lesson(
    factory: SimulationFactory,
    new_setup: Callable[[], RivalSetup],
    loop: DriveLoop,
    report: Report,
    teach_on_bus: TeachOnBus | None = None,
) -> RivalLesson:
    """Give the task's lesson; over the CAN bus if `loop` says so, or if the robot leaves the batch.

    Args:
        factory: opens the simulation.
        new_setup: returns the setup, with learners that know nothing; called again if the robot leaves the batch.
        loop: that drives the robot.
        report: gets the simulated seconds.
        teach_on_bus: gives the lesson over the CAN bus; None: `teach_rival`.

    Raises:
        BatchRefusedError: the batch does not know the task or its teacher, or a learner failed.
        LessonLostError: the robot refused a command.
        hal.settings.SettingsError: task and world do not fit.
    """
    setup = new_setup()
    world, seconds = setup.task.teaching.world, setup.task.teaching.duration_s

    def on_progress(done_s: float) -> None:
        report(f"teaching in world {world}", done_s, seconds)

    given = None
    if loop is DriveLoop.BATCH and isinstance(factory, LessonFactory):
        given = _teach_in_batch(factory, setup, on_progress)
        if given is None:  # the learners were taught a part of it
            setup = new_setup()
    if given is None:
        with closing(factory.open(world, setup.seed, "lesson")) as simulation:
            given = await (teach_on_bus or teach_rival)(simulation, setup, on_progress)
    on_progress(seconds)
    return given


async def teach_rival(
    simulation: Simulation, setup: RivalSetup, on_progress: OnProgress, plan: LessonPlan | None = None
) -> RivalLesson:
    """Give the task's lesson over the CAN bus, or that of another plan.

    Args:
        simulation: that the robot drives in.
        setup: of robot and teacher.
        on_progress: gets the simulated seconds.
        plan: None: the task's own, phases 1 and 2.

    Raises:
        LessonLostError: the robot refused a command.
        hal.settings.SettingsError: task and world do not fit.
    """
    store, plan = InMemoryEventStore(), plan or plan_of(setup.task)
    training = TrainingStore(store, learners=setup.team)
    runtime = build_training_runtime(simulation, setup.robot, setup.task, training, appraises=plan.appraises)
    run = MarkedRun(simulation, runtime, store, setup, on_progress=on_progress, plan=plan)
    await run.drive()
    return run.lesson()


def _teach_in_batch(factory: LessonFactory, setup: RivalSetup, on_progress: OnProgress) -> RivalLesson | None:
    """Give the task's lesson in a batch, as `teach_rival` does; return None if it belongs on the CAN bus."""
    with open_batch_lesson(
        factory, setup.robot, setup.task, seed=setup.seed, on_progress=on_progress, learners=setup.team
    ) as run:
        pressed = PressMarks(setup.after, lambda: run.events, setup.team)
        run.on_stretch = lambda: pressed.update(run.presses, run.ticks * run.period_s)
        if not run.drive_stretches():
            return None
        causes = run.robot.log.causes[1 : run.ticks + 1]
        driven_s, waited_s = (
            int((causes == cause).sum()) * run.period_s for cause in (LessonCause.TEACHER, LessonCause.UNKNOWN)
        )
        marks = pressed.at_end(run.presses, run.ticks * run.period_s)
        actions = [None if place < 0 else place for place in run.robot.log.actions[: run.ticks + 1].tolist()]
        changes = ticks_to_change(run.correction_ticks, actions)
        return RivalLesson(setup, run.runtime, run.result(), marks, driven_s, waited_s, changes)


def ticks_to_change(corrections: Sequence[int], actions: Sequence[str | int | None]) -> tuple[int, ...]:
    """Return the ticks from each correction of a robot that drove to the first tick of another action, or of none.

    Args:
        corrections: ticks in which they were sent, ascending.
        actions: action that drove in each tick, None for none; the first one is before the first tick.
    """
    found = []
    for tick in corrections:
        wrong = actions[tick]
        changed = (after for after in range(tick + 1, len(actions)) if actions[after] != wrong)
        first = None if wrong is None else next(changed, None)
        if first is not None:
            found.append(first - tick)
    return tuple(found)


def session_of(plan: LessonPlan, seed: int) -> str:
    """Return the prefix of the command ids of a robot's lesson."""
    return f"{plan.purpose}-{seed}-after-0"


class MarkedRun(TrainingRun):
    """Training run that marks the knowledge before the press that follows each number of a setup."""

    def __init__(
        self,
        simulation: Simulation,
        runtime: Runtime,
        store: InMemoryEventStore,
        setup: RivalSetup,
        *,
        on_progress: OnProgress,
        plan: LessonPlan,
        answering: BasicTeacher | None = None,
    ) -> None:
        """Begin the run; `answering`: None: the task's own."""
        super().__init__(
            simulation,
            runtime,
            plan,
            seed=setup.seed,
            session=session_of(plan, setup.seed),
            on_progress=on_progress,
            answering=answering,
        )
        self._setup = setup
        self._pressed = PressMarks(setup.after, lambda: store.events, setup.team)
        self._driven_ticks = self._waiting_ticks = 0
        self._actions: list[str | None] = [None]

    def on_tick(self, record: TickRecord) -> None:
        """Let the teacher react, and mark the knowledge."""
        super().on_tick(record)
        decision = record.decision
        self._actions.append(decision.action)
        self._driven_ticks += decision.cause is DecisionCause.TEACHER
        self._waiting_ticks += decision.asking
        self._pressed.update(self.presses, record.tick * self.period_s)

    def lesson(self) -> RivalLesson:
        """Return the result with the marks."""
        return RivalLesson(
            self._setup,
            self.runtime,
            self.result(),
            self._pressed.at_end(self.presses, self.ticks * self.period_s),
            self._driven_ticks * self.period_s,
            self._waiting_ticks * self.period_s,
            ticks_to_change(self.correction_ticks, self._actions),
        )
