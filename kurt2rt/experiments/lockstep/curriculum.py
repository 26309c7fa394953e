"""Training run and exams of one robot, each in a world that is opened for it."""

from collections.abc import Callable, Sequence
from contextlib import closing
from dataclasses import replace
from pathlib import Path

from hal.robot_settings import RobotSettings
from kurt2rt.core.learner.learner_team import LearnerTeam
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.batch_exam import examine_in_batch
from kurt2rt.experiments.lockstep.batch_lesson import teach_in_batch
from kurt2rt.experiments.lockstep.batch_mind import refused
from kurt2rt.experiments.lockstep.drive_row import DriveRow
from kurt2rt.experiments.lockstep.engine import Engine
from kurt2rt.experiments.lockstep.exam import ExamSetup, examine
from kurt2rt.experiments.lockstep.faulty_sensor import SensorBreak
from kurt2rt.experiments.lockstep.lesson import GivenLesson, teach
from kurt2rt.experiments.lockstep.lesson_keeping import lessons_kept
from kurt2rt.experiments.lockstep.lesson_plan import LessonPlan, plan_of
from kurt2rt.knowledge.journal.loading import read_lessons
from kurt2rt.knowledge.journal.writer import Acknowledgement
from simbridge.contracts.batch import BatchFactory, BatchRefusedError
from simbridge.contracts.batch_lesson import LessonFactory
from simbridge.contracts.simulation import SimulationFactory

Report = Callable[[str, float, float], None]
"""Progress of a long job: what, simulated seconds done, simulated seconds in all."""


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
    learners: LearnerTeam | None = None,
) -> GivenLesson:
    """Teach, with the lessons kept in the file `knowledge`; return the result with all events the file then holds.

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
        learners: taught in place of the RLAs, and without knowledge yet; None: RLAs decide.

    Raises:
        KnowledgeError: the file cannot be used.
        SettingsError: task and world do not fit.
        LessonLostError: the robot refused a command, or a lesson was not stored.
        BatchRefusedError: a batch, which does not know the lesson, shall drive it; or a robot with learners left the
            batch, after a part of their lesson.
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
            if not isinstance(factory, LessonFactory):
                raise BatchRefusedError("this simulation has no batch", do="teach on the CAN bus")
            given = teach_in_batch(factory, settings, task, seed=seed, on_progress=on_progress, learners=learners)
            if given is None and learners is not None:
                raise refused(task, "how a robot with learners goes on that it cannot drive")
        if given is None:
            training = replace(keeping.training, learners=learners)
            with closing(factory.open(world, seed, plan.purpose)) as simulation:
                lesson = await teach(
                    simulation, settings, task, training, seed=seed, on_progress=on_progress, plan=plan
                )
        else:
            lesson = given.result
            for event in given.events:
                keeping.writer.submit(event)
        keeping.end(lesson.saved)
        report(f"teaching in world {world}", whole_s, whole_s)
    return GivenLesson(lesson, read_lessons(knowledge, settings, task))


async def run_exam(
    factory: SimulationFactory, settings: RobotSettings, task: TaskSettings, setup: ExamSetup, report: Report
) -> DriveRow:
    """Open the setup's world, drive there over the CAN bus without a teacher and return the result.

    Raises:
        SettingsError: task and world do not fit.
        LessonLostError: the robot refused a command.
    """
    drive_name = _drive_name(setup)
    with closing(factory.open(setup.world, setup.seed, "exam")) as simulation:
        return await examine(
            simulation, settings, task, setup, lambda done_s: report(drive_name, done_s, task.exam.duration_s)
        )


async def run_drives(
    factory: SimulationFactory,
    settings: RobotSettings,
    task: TaskSettings,
    setups: Sequence[ExamSetup],
    report: Report,
    engine: Engine = Engine.CAN,
    *,
    measured: bool = True,
) -> list[DriveRow]:
    """Drive exams without a teacher, each in its world, and return their results in order.

    Args:
        factory: opens the simulations.
        settings: of the robot.
        task: of all exams.
        setups: of the exams.
        report: progress callback.
        engine: a batch drives all at once, and leaves some robots to the CAN bus.
        measured: False for results as `DriveRow.counted` returns them, which a batch has sooner, without places.

    Raises:
        SettingsError: task and world do not fit.
        LessonLostError: the robot refused a command.
        UnknownActionError, UnknownBehaviourError: the knowledge does not fit the task.
        BatchRefusedError: a batch, which does not know the task, shall drive it.
    """
    finished: list[DriveRow | None] = [None] * len(setups)
    if engine is Engine.COMPILED:
        if not isinstance(factory, BatchFactory):
            raise BatchRefusedError("this simulation has no batch", do="examine on the CAN bus")
        finished = examine_in_batch(factory, settings, task, setups, measured=measured)
    results = []
    for setup, in_batch in zip(setups, finished, strict=True):
        if in_batch is None:
            in_batch = await run_exam(factory, settings, task, setup, report)
        else:
            report(_drive_name(setup), task.exam.duration_s, task.exam.duration_s)
        results.append(in_batch if measured else in_batch.counted())
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
) -> tuple[DriveRow, ...]:
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
        One drive per world, in order, with its verdict and the teacher's.

    Raises:
        SettingsError: task and world do not fit.
        LessonLostError: the robot refused a command.
        BatchRefusedError: a batch, which does not know the task, shall drive it.
    """
    setups = [
        each
        for world in worlds
        for each in (ExamSetup(world, seed, events=events, broken=broken), ExamSetup(world, seed, teacher_policy=True))
    ]
    drives = await run_drives(factory, settings, task, setups, report, engine)
    return tuple(
        learned.judged_by(teacher.progress, task.exam.success).model_copy(update={"teacher": teacher.as_measure()})
        for learned, teacher in zip(drives[::2], drives[1::2], strict=True)
    )


def _drive_name(setup: ExamSetup) -> str:
    what = "the teacher's own drive" if setup.teacher_policy else "exam without teacher"
    return f"{what}, world {setup.world}"
