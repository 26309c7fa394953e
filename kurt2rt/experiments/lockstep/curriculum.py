"""Curriculum of one seed: a training run and its exams."""

from collections.abc import Callable, Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

from hal.batch import BatchFactory, BatchRefusedError
from hal.batch_lesson import LessonFactory
from hal.robot_settings import RobotSettings
from hal.simulation import SimulationFactory
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.batch_exam import BatchExam, examine_in_batch
from kurt2rt.experiments.lockstep.batch_lesson import teach_in_batch
from kurt2rt.experiments.lockstep.batch_mind import refused
from kurt2rt.experiments.lockstep.engine import Engine
from kurt2rt.experiments.lockstep.exam import ExamResult, ExamSetup, examine
from kurt2rt.experiments.lockstep.exam_verdict import ExamVerdict
from kurt2rt.experiments.lockstep.faulty_sensor import SensorBreak
from kurt2rt.experiments.lockstep.given_lesson import GivenLesson
from kurt2rt.experiments.lockstep.lesson import TrainingResult, teach
from kurt2rt.experiments.lockstep.lesson_keeping import lessons_kept
from kurt2rt.experiments.lockstep.lesson_plan import LessonPlan, plan_of
from kurt2rt.knowledge.journal.loading import read_lessons
from kurt2rt.knowledge.journal.writer import Acknowledgement

Report = Callable[[str, float, float], None]
"""Progress of a long job: what, simulated seconds done, simulated seconds in all."""


@dataclass(frozen=True, slots=True)
class WorldResult:
    """Exam in one world, with the teacher's own drive there."""

    learned: ExamResult
    teacher: ExamResult
    verdict: ExamVerdict

    @property
    def succeeded(self) -> bool:
        """True if the exam was judged and passed."""
        return self.verdict is ExamVerdict.PASSED


@dataclass(frozen=True, slots=True)
class CurriculumResult:
    """Result of a training run: a simulated session with a teacher, then an exam in each world.

    `kurt2rt train` prints one per robot. The seed decides all of it, bit for bit.
    """

    lesson: TrainingResult
    exams: tuple[WorldResult, ...]


async def run_lesson(
    factory: SimulationFactory,
    settings: RobotSettings,
    task: TaskSettings,
    knowledge: Path,
    *,
    seed: int,
    report: Report,
    on_saved: Callable[[Acknowledgement], None] = lambda _: None,
    plan: LessonPlan | None = None,
    engine: Engine = Engine.CAN,
) -> tuple[TrainingResult, list[TeachingEvent]]:
    """Teach, with the lessons kept in the file `knowledge`; return the result and all events the file then holds.

    Goes on from the lessons in the file.

    Args:
        factory: opens the simulation.
        settings: of the robot.
        task: to teach.
        knowledge: path of the file.
        seed: of the robot and the teacher.
        report: progress callback.
        on_saved: gets each acknowledgement of a durable lesson.
        plan: None: the task's own lesson, phases 1 and 2. A batch knows no other one.
        engine: drives the robot; a batch begins without knowledge, and leaves some robots to the CAN bus.

    Raises:
        KnowledgeError: the file cannot be used.
        SettingsError: task and world do not fit.
        LessonLostError: the robot refused a command, or a lesson was not stored.
        BatchRefusedError: a batch, which does not know the lesson, shall drive it.
    """
    if engine is Engine.COMPILED and plan is not None:
        raise refused(task, "a plan of its own")
    plan = plan or plan_of(task)
    world, whole_s = task.teaching.world, plan.duration_s
    with lessons_kept(knowledge, settings, task, on_saved) as keeping:
        on_progress = keeping.telling(report, f"teaching in world {world}", whole_s)
        given: GivenLesson | None = None
        if engine is Engine.COMPILED:
            if keeping.opened.events:
                raise refused(task, "knowledge to go on from")
            given = _teach_in_batch(factory, settings, task, seed, on_progress)
        if given is None:
            with closing(factory.open(world, seed, plan.purpose)) as simulation:
                lesson = await teach(
                    simulation, settings, task, keeping.training, seed=seed, on_progress=on_progress, plan=plan
                )
        else:
            lesson = given.result
            for event in given.events:
                keeping.writer.submit(event)
        keeping.end(lesson.saved)
        report(f"teaching in world {world}", whole_s, whole_s)
    return lesson, read_lessons(knowledge, settings, task)


async def run_exam(
    factory: SimulationFactory,
    settings: RobotSettings,
    task: TaskSettings,
    events: Sequence[TeachingEvent],
    setup: ExamSetup,
    report: Report,
) -> ExamResult:
    """Open the setup's world, drive there over the CAN bus without a teacher and return the result.

    `events`: lessons of the robot; the policy's own drive does without them.

    Raises:
        SettingsError: task and world do not fit.
        LessonLostError: the robot refused a command.
    """
    drive_name = _drive_name(setup)
    with closing(factory.open(setup.world, setup.seed, "exam")) as simulation:
        return await examine(
            simulation,
            settings,
            task,
            events,
            setup,
            lambda done_s: report(drive_name, done_s, task.exam.duration_s),
        )


async def run_drives(
    factory: SimulationFactory,
    settings: RobotSettings,
    task: TaskSettings,
    drives: Sequence[BatchExam],
    report: Report,
    engine: Engine = Engine.CAN,
) -> list[ExamResult]:
    """Drive exams without a teacher, each in its world, and return their results in order.

    Args:
        factory: opens the simulations.
        settings: of the robot.
        task: of all exams.
        drives: setups with the lessons of the robot.
        report: progress callback.
        engine: a batch drives all at once, and leaves some robots to the CAN bus.

    Raises:
        SettingsError: task and world do not fit.
        LessonLostError: the robot refused a command.
        UnknownActionError, UnknownBehaviourError: the knowledge does not fit the task.
        BatchRefusedError: a batch, which does not know the task, shall drive it.
    """
    finished: list[ExamResult | None] = [None] * len(drives)
    if engine is Engine.COMPILED:
        finished = _run_in_batch(factory, settings, task, drives)
    results = []
    for each, in_batch in zip(drives, finished, strict=True):
        if in_batch is None:
            in_batch = await run_exam(factory, settings, task, each.events, each.setup, report)
        else:
            report(_drive_name(each.setup), task.exam.duration_s, task.exam.duration_s)
        results.append(in_batch)
    return results


async def run_exams(
    factory: SimulationFactory,
    settings: RobotSettings,
    task: TaskSettings,
    events: Sequence[TeachingEvent],
    worlds: Sequence[str],
    *,
    seed: int,
    report: Report,
    engine: Engine = Engine.CAN,
    broken: SensorBreak | None = None,
) -> tuple[WorldResult, ...]:
    """Examine in each world, and let the teacher's policy drive there for comparison, from the same start.

    Args:
        factory: opens the simulations.
        settings: of the robot.
        task: that was taught.
        events: its lessons.
        worlds: names of the worlds.
        seed: of robot and start pose.
        report: progress callback.
        engine: drives the exams.
        broken: sensor of the robot that breaks, but not while the teacher's policy drives; None: none.

    Returns:
        One result per world, in order.

    Raises:
        SettingsError: task and world do not fit.
        LessonLostError: the robot refused a command.
        BatchRefusedError: a batch, which does not know the task, shall drive it.
    """
    setups = [
        each for world in worlds for each in (ExamSetup(world, seed, broken=broken), ExamSetup(world, seed, True))
    ]
    drives = await run_drives(factory, settings, task, [BatchExam(each, events) for each in setups], report, engine)
    return tuple(
        WorldResult(learned, teacher, learned.verdict(teacher.progress, task.exam.success))
        for learned, teacher in zip(drives[::2], drives[1::2], strict=True)
    )


def _run_in_batch(
    factory: SimulationFactory, settings: RobotSettings, task: TaskSettings, exams: Sequence[BatchExam]
) -> list[ExamResult | None]:
    if not isinstance(factory, BatchFactory):
        raise BatchRefusedError("this simulation has no batch", do="examine on the CAN bus")
    return examine_in_batch(factory, settings, task, exams)


def _teach_in_batch(
    factory: SimulationFactory,
    settings: RobotSettings,
    task: TaskSettings,
    seed: int,
    on_progress: Callable[[float], None],
) -> GivenLesson | None:
    if not isinstance(factory, LessonFactory):
        raise BatchRefusedError("this simulation has no batch", do="teach on the CAN bus")
    return teach_in_batch(factory, settings, task, seed=seed, on_progress=on_progress)


def _drive_name(setup: ExamSetup) -> str:
    what = "the teacher's own drive" if setup.teacher_policy else "exam without teacher"
    return f"{what}, world {setup.world}"
