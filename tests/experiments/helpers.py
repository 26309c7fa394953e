"""Short lessons and exams on the simulated robot."""

from collections.abc import Sequence
from contextlib import closing
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import anyio

from hal.kurt2_settings import load_kurt2
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.task_settings import TaskSettings, load_task
from kurt2rt.experiments.lockstep.curriculum import run_exams, run_lesson
from kurt2rt.experiments.lockstep.drive_row import DriveRow
from kurt2rt.experiments.lockstep.engine import Engine
from kurt2rt.experiments.lockstep.exam import ExamSetup, examine
from kurt2rt.experiments.lockstep.lesson import TrainingResult
from kurt2rt.experiments.lockstep.lesson_plan import LessonPlan
from kurt2rt.knowledge.journal.writer import Acknowledgement
from simbridge.simulation import Kurt2SimulationFactory

ROBOT = load_kurt2()
STAGE = Kurt2SimulationFactory(ROBOT)


def short_task(
    supervised_s: float = 9.0,
    corrections_s: float = 6.0,
    exam_s: float = 20.0,
    *,
    radius: float | None = None,
    **of_exam: object,
) -> TaskSettings:
    """Wall following with less time for everything."""
    task = load_task("wall_following")
    learning = task.learning if radius is None else task.learning.model_copy(update={"radius": radius})
    teaching = task.teaching.model_copy(update={"supervised_s": supervised_s, "corrections_s": corrections_s})
    exam = task.exam.model_copy(update={"worlds": ("a",), "duration_s": exam_s, **of_exam})
    return task.model_copy(update={"learning": learning, "teaching": teaching, "exam": exam})


@dataclass(frozen=True)
class Taught:
    """All that one lesson left behind."""

    task: TaskSettings
    knowledge: Path
    result: TrainingResult
    events: list[TeachingEvent]
    saved: list[Acknowledgement]
    """Acknowledgements given to `on_saved`, in order."""
    reported_s: list[float]


def teach(
    knowledge: Path,
    task: TaskSettings | None = None,
    seed: int = 1,
    *,
    stage: Kurt2SimulationFactory = STAGE,
    plan: LessonPlan | None = None,
    engine: Engine = Engine.CAN,
) -> Taught:
    """Give one lesson into a knowledge file."""
    saved: list[Acknowledgement] = []
    reported_s: list[float] = []
    task = task or short_task()

    async def lesson() -> tuple[TrainingResult, list[TeachingEvent]]:
        return await run_lesson(
            *(stage, ROBOT, task, knowledge),
            seed=seed,
            report=lambda _what, done_s, _whole_s: reported_s.append(done_s),
            on_saved=saved.append,
            plan=plan,
            engine=engine,
        )

    result, events = anyio.run(lesson)
    return Taught(task, knowledge, result, events, saved, reported_s)


def examined(
    task: TaskSettings,
    events: Sequence[TeachingEvent] = (),
    worlds: Sequence[str] = ("a",),
    seed: int = 1,
    *,
    stage: Kurt2SimulationFactory = STAGE,
    engine: Engine = Engine.CAN,
) -> tuple[DriveRow, ...]:
    """Return the exams of a robot with these lessons in these worlds."""
    exams = partial(run_exams, stage, ROBOT, task, events, worlds, seed=seed, report=lambda *_: None, engine=engine)
    return anyio.run(exams)


def teachers_drive(task: TaskSettings) -> DriveRow:
    """Return the exam result of the teacher's own policy in the exam's first world."""
    setup = ExamSetup(task.exam.worlds[0], 1, teacher_policy=True)
    return exam_on_bus(task, setup)


def exam_on_bus(task: TaskSettings, setup: ExamSetup) -> DriveRow:
    """Return the result of an exam on the CAN bus."""
    with closing(STAGE.open(setup.world, setup.seed, "exam")) as simulation:
        return anyio.run(examine, simulation, ROBOT, task, setup, lambda _: None)
