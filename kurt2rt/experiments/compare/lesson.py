"""Lesson of a pupil: the training run of every robot, with what it knew after given numbers of presses."""

from collections.abc import Callable, Sequence
from contextlib import closing
from dataclasses import dataclass

from hal.batch_lesson import LessonFactory
from hal.robot_settings import RobotSettings
from hal.simulation import Simulation, SimulationFactory
from kurt2rt.core.event_store import InMemoryEventStore
from kurt2rt.core.learner.learner import Label
from kurt2rt.core.learner.learner_team import LearnerTeam
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.experiments.lockstep.batch_lesson import open_batch_lesson
from kurt2rt.experiments.lockstep.curriculum import Report
from kurt2rt.experiments.lockstep.engine import Engine
from kurt2rt.experiments.lockstep.lesson import TrainingResult, TrainingRun
from kurt2rt.experiments.lockstep.lesson_plan import plan_of
from kurt2rt.experiments.lockstep.runtimes import TrainingStore, build_training_runtime

OnProgress = Callable[[float], None]
"""Called once a second with the simulated seconds."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LessonSetup:
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
class Mark:
    """Knowledge after a number of presses."""

    presses: int
    """Number asked for; a robot that gave cause for fewer has all that it was taught."""
    events: tuple[TeachingEvent, ...]
    """Lessons so far, which are the knowledge of RLAs."""
    labels: tuple[Label, ...]
    """Standing labels so far, which are the knowledge of a learner; empty for RLAs."""
    teaching_s: float


@dataclass(frozen=True, slots=True)
class PupilLesson:
    """Lesson of one robot."""

    setup: LessonSetup
    result: TrainingResult
    marks: tuple[Mark, ...]
    """Marks after the numbers of presses asked for, ascending; the last one is at the end of the lesson."""


class PressMarks:
    """Marks of one lesson."""

    def __init__(self, setup: LessonSetup, events: Callable[[], Sequence[TeachingEvent]]) -> None:
        """Mark the knowledge before the press that follows each number of the setup; `events`: all lessons so far."""
        self._after, self._team, self._events = setup.after, setup.team, events
        self._marks: list[Mark] = []

    def update(self, presses: int, teaching_s: float) -> None:
        """Mark the knowledge if a press too many was sent, which a later tick applies.

        Args:
            presses: number that was sent so far.
            teaching_s: time of teaching so far, in s.
        """
        while len(self._marks) < len(self._after) and presses > self._after[len(self._marks)]:
            self._marks.append(self._mark(self._after[len(self._marks)], teaching_s))

    def at_end(self, presses: int, teaching_s: float) -> tuple[Mark, ...]:
        """Return all marks and that of the end; those that were not reached are of the end, too."""
        missing = (*self._after[len(self._marks) :], presses)
        return (*self._marks, *(self._mark(each, teaching_s) for each in missing))

    def _mark(self, presses: int, teaching_s: float) -> Mark:
        labels = () if self._team is None else self._team.labels
        return Mark(presses, tuple(self._events()), labels, teaching_s)


async def give_lesson(
    factory: SimulationFactory, new_setup: Callable[[], LessonSetup], engine: Engine, report: Report
) -> PupilLesson:
    """Give the task's lesson; over the CAN bus if `engine` says so, or if the robot leaves the batch.

    Args:
        factory: opens the simulation.
        new_setup: returns the setup, with learners that know nothing; called again if the robot leaves the batch.
        engine: that drives the robot.
        report: gets the simulated seconds.

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
    if engine is Engine.COMPILED and isinstance(factory, LessonFactory):
        given = _teach_in_batch(factory, setup, on_progress)
        if given is None:  # the learners were taught a part of it
            setup = new_setup()
    if given is None:
        with closing(factory.open(world, setup.seed, "lesson")) as simulation:
            given = await teach_on_bus(simulation, setup, on_progress)
    on_progress(seconds)
    return given


async def teach_on_bus(simulation: Simulation, setup: LessonSetup, on_progress: OnProgress) -> PupilLesson:
    """Give the task's lesson over the CAN bus. Raises LessonLostError, hal.settings.SettingsError."""
    run = _MarkedRun(simulation, setup, on_progress)
    await run.drive()
    return run.lesson()


def _teach_in_batch(factory: LessonFactory, setup: LessonSetup, on_progress: OnProgress) -> PupilLesson | None:
    """Give the task's lesson in a batch, as `teach_on_bus` does; return None if it belongs on the CAN bus."""
    with open_batch_lesson(
        factory, setup.robot, setup.task, seed=setup.seed, on_progress=on_progress, learners=setup.team
    ) as run:
        marks = PressMarks(setup, lambda: run.events)
        run.on_stretch = lambda: marks.update(run.presses, run.ticks * run.period_s)
        if not run.drive_stretches():
            return None
        return PupilLesson(setup, run.result(), marks.at_end(run.presses, run.ticks * run.period_s))


class _MarkedRun(TrainingRun):
    """Training run that marks the knowledge before the press that follows each number of a setup."""

    def __init__(self, simulation: Simulation, setup: LessonSetup, on_progress: OnProgress) -> None:
        store, plan = InMemoryEventStore(), plan_of(setup.task)
        training = TrainingStore(store, learners=setup.team)
        runtime = build_training_runtime(simulation, setup.robot, setup.task, training, appraises=plan.appraises)
        session = f"{plan.purpose}-{setup.seed}-after-0"
        super().__init__(simulation, runtime, plan, seed=setup.seed, session=session, on_progress=on_progress)
        self._setup = setup
        self._marks = PressMarks(setup, lambda: store.events)

    def on_tick(self, record: TickRecord) -> None:
        """Let the teacher react, and mark the knowledge."""
        super().on_tick(record)
        self._marks.update(self.presses, record.tick * self.period_s)

    def lesson(self) -> PupilLesson:
        """Return the result with the marks."""
        return PupilLesson(self._setup, self.result(), self._marks.at_end(self.presses, self.ticks * self.period_s))
